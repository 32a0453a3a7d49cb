"""Files that appear whole or not at all."""

import hashlib
import json
import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

TEMPORARY_PREFIX = ".partial-"
"""Start of the name of a file that is not yet whole; a killed process leaves such a file behind."""

ABANDONED = 86400.0
"""Age in seconds from which an unfinished file counts as abandoned. Writing one takes seconds."""

DIGEST_BYTES = hashlib.sha256().digest_size
"""Bytes of the checksum at the head of a sealed file."""


def write_whole(path: Path, write: Callable[..., Any]) -> None:
    """Write a file so that ``path`` holds either what it held before or all that is new.

    Parameters
    ----------
    path : Path
        Folders above it are made where they are missing.
    write : callable
        Called with the path of a temporary file beside ``path``, which is then synchronised and renamed.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=TEMPORARY_PREFIX, suffix=path.suffix, dir=path.parent)
    os.close(handle)
    partial = Path(name)
    try:
        write(partial)
        with open(partial, "rb+") as file:  # Windows synchronises what it may write
            os.fsync(file.fileno())
        partial.chmod(0o644)
        os.replace(partial, path)
        _synchronise(path.parent)
    finally:
        partial.unlink(missing_ok=True)


def _synchronise(folder: Path) -> None:
    """Have the disk hold a folder's names; Windows opens no folder."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_text(path: Path, text: str) -> None:
    """Write text, in UTF-8, whole or not at all."""
    write_whole(path, lambda partial: partial.write_text(text, encoding="utf-8"))


def write_json(path: Path, content: Any) -> None:
    """Write plain data as JSON, whole or not at all."""
    write_text(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def read_json(path: str | Path) -> dict[str, Any]:
    """What a file of JSON holds; {} where there is no such file, or a damaged one."""
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def file_digest(path: str | os.PathLike[str]) -> str | None:
    """SHA-256 of a file's content; None where there is no file that can be read."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except (OSError, ValueError):  # a path with a zero byte is a ValueError
        return None


def sealed(payload: bytes, seal: str) -> bytes:
    """A checksum over ``seal`` and payload, then the payload. The seal says what the payload is."""
    return hashlib.sha256(seal.encode() + payload).digest() + payload


def unsealed(content: bytes, seal: str) -> bytes | None:
    """The payload that `sealed` made with the same seal; None where it is damaged or another one."""
    payload = content[DIGEST_BYTES:]
    return payload if sealed(payload, seal) == content else None


def remove_abandoned(folder: Path, age: float, now: float) -> None:
    """Remove unfinished files in a folder that are older than ``age``, in seconds at the time ``now``.

    Other processes may remove the same files.
    """
    for partial in folder.glob(f"{TEMPORARY_PREFIX}*"):
        with suppress(OSError):
            if now - partial.stat().st_mtime > age:
                partial.unlink()
