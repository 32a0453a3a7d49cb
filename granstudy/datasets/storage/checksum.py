"""Checksums of a file of a dataset: over all its bytes, and over its head, which is all but densities.

They are attributes of the file, the first ones, so that they are checked before anything else is read:

=================  ==================================================================
`checksum`         SHA-256 of the whole file
`head_checksum`    SHA-256 of its first bytes, where all lies but what is over velocities
`head_bytes`       their number
=================  ==================================================================

The values of the three count as zeros.
"""

import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from granstudy.datasets.storage.classic import attribute
from granstudy.support.errors import DamagedFileError

BLANK = {"checksum": "0" * 64, "head_checksum": "0" * 64, "head_bytes": np.int64(0)}
"""The three attributes before the bytes of the file are known."""

ZEROS = b"".join(attribute(name, value) for name, value in BLANK.items())
"""Their bytes."""

HEX = re.compile(b"0{64}")
"""A checksum among them."""

VALUES = (*(found.span() for found in HEX.finditer(ZEROS)), (len(ZEROS) - 8, len(ZEROS)))
"""Where the three values stand among them."""

MARK = ZEROS[: ZEROS.index(b"0" * 64)]
"""Bytes that stand before the first checksum."""

REMEDY = "delete it, and compute the run again (snakemake does, once the file is gone)"
"""What to do about a damaged file."""

CHUNK = 1 << 16
"""Bytes read at once to find the head."""


def sealed(header: bytes, head: Iterable[bytes], rest: Iterable[bytes]) -> bytes:
    """The header of a file with its checksums in place of `BLANK`.

    Parameters
    ----------
    header : bytes
    head, rest : iterable of bytes
        What follows the header: values that the head of the file holds, and all others.
    """
    digest, size = hashlib.sha256(header), len(header)
    for data in head:
        digest.update(data)
        size += len(data)
    of_head = digest.hexdigest()
    for data in rest:
        digest.update(data)
    found = {"checksum": digest.hexdigest(), "head_checksum": of_head, "head_bytes": np.int64(size)}
    seal = b"".join(attribute(name, value) for name, value in found.items())
    at = header.index(ZEROS)
    return header[:at] + seal + header[at + len(ZEROS) :]


def checked_file(path: str | Path) -> bytes:
    """The bytes of a file.

    Raises
    ------
    DamagedFileError
        If they do not match the file's checksum, or it has none.
    """
    data = Path(path).read_bytes()
    at = _seal(path, data)
    _compare(path, data, at, VALUES[0])
    return data


def checked_head(path: str | Path, verify: bool = True) -> bytes:
    """The bytes of the head of a file.

    Parameters
    ----------
    verify : bool
        Whether they are compared with their checksum; and with that of the file, where there is nothing else
        in it.

    Raises
    ------
    DamagedFileError
        If they do not match the checksum of the head, or the file has none.
    """
    with open(path, "rb") as file:
        data = file.read(CHUNK)
        at = _seal(path, data)
        size = int.from_bytes(data[at + len(ZEROS) - 8 : at + len(ZEROS)], "big")
        if size > len(data):
            data += file.read(size - len(data))
        is_whole = len(data) == size and not file.read(1)
    if size > len(data):
        raise damaged(path, "it is shorter than it says")
    data = data[:size]
    if verify:
        for span in VALUES[:2] if is_whole else VALUES[1:2]:
            _compare(path, data, at, span)
    return data


def damaged(path: str | Path, why: str) -> DamagedFileError:
    """The error for a damaged file."""
    return DamagedFileError(f"{path}: is damaged, or granstudy did not write it: {why}; {REMEDY}")


def _seal(path: str | Path, data: bytes) -> int:
    """Where the checksums stand."""
    at = data.find(MARK)
    if at < 0 or len(data) < at + len(ZEROS):
        raise damaged(path, "it has no checksum")
    return at


def _compare(path: str | Path, data: bytes, at: int, span: tuple[int, int]) -> None:
    """Raise DamagedFileError unless data have the checksum that stands at a span of their attributes."""
    digest, view, end = hashlib.sha256(), memoryview(data), at + len(ZEROS)
    blank = bytearray(view[at:end])
    stated = blank[slice(*span)]
    for first, last in VALUES:
        blank[first:last] = ZEROS[first:last]
    for part in (view[:at], blank, view[end:]):
        digest.update(part)
    if digest.hexdigest().encode() != stated:
        raise damaged(path, "its contents do not match its checksum")
