"""NetCDF's classic format (CDF-5) as bytes: written and read without the HDF5 library.

All that a run's dataset holds fits the format: named axes, attributes, arrays of numbers, and text as
characters of fixed width. Every NetCDF tool reads it. The layout is that of the appendix "File Format
Specifications" of the NetCDF User's Guide. Such files need no HDF5, which hangs or crashes on some damaged
files, and takes several milliseconds to open a sound one.
"""

import math
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

MAGIC = b"CDF\x05"
"""First bytes of a file."""

DIMENSION, VARIABLE, ATTRIBUTE = 10, 11, 12
"""Tags of the three lists in a header."""

TYPES = {"i1": 1, "S1": 2, "i2": 3, "i4": 4, "f4": 5, "f8": 6}
TYPES |= {"u1": 7, "u2": 8, "u4": 9, "i8": 10, "u8": 11}
"""Numbers that stand for the types of values."""

DTYPES = {number: np.dtype(f">{code}") for code, number in TYPES.items()}
"""The types themselves, as they lie in the file."""


@dataclass(frozen=True)
class Stored:
    """A variable in a file: its axes, type, place and attributes."""

    dims: tuple[str, ...]
    dtype: np.dtype
    shape: tuple[int, ...]
    begin: int
    attrs: dict[str, Any] = field(default_factory=dict)

    def values(self, data: bytes | memoryview) -> np.ndarray:
        """The values in the bytes of the file, in the machine's own order of bytes."""
        count = math.prod(self.shape)
        flat = np.frombuffer(data, self.dtype, count, self.begin)
        return flat.reshape(self.shape).astype(self.dtype.newbyteorder("="))


@dataclass(frozen=True)
class Header:
    """What a file says of itself: attributes of the file, and its variables by name."""

    attrs: dict[str, Any]
    variables: dict[str, Stored]


def pack(
    attrs: Mapping[str, Any],
    variables: Mapping[str, tuple[Sequence[str], np.ndarray, Mapping[str, Any]]],
) -> Iterator[bytes]:
    """The bytes of a file: first the header, then the values of each variable in the given order.

    Parameters
    ----------
    attrs : mapping
        Attributes of the file: text, numbers, or arrays of numbers with one axis.
    variables : mapping
        Axes, values and attributes by name. Values are of the types in `TYPES`; no axis is empty.

    Raises
    ------
    ValueError
        For values of another type, and for variables that differ in the length of an axis.
    """
    sizes: dict[str, int] = {}
    for name, (dims, values, _) in variables.items():
        for dim, size in zip(dims, values.shape, strict=True):
            if sizes.setdefault(dim, size) != size:
                raise ValueError(f"{name}: has length {size} along {dim!r}, others {sizes[dim]}")
    axes = {dim: number for number, dim in enumerate(sizes)}
    start = MAGIC + struct.pack(">q", 0)
    start += _listed(DIMENSION, (_name(dim) + struct.pack(">q", n) for dim, n in sizes.items()))
    start += _attributes(attrs)
    descriptions = [
        (
            _name(name)
            + struct.pack(f">q{len(dims)}q", len(dims), *(axes[dim] for dim in dims))
            + _attributes(own)
            + struct.pack(">iq", _type(name, values), _padded(values.nbytes)),
            _padded(values.nbytes),
        )
        for name, (dims, values, own) in variables.items()
    ]
    begin = len(start) + 12 + sum(len(text) + 8 for text, _ in descriptions)
    placed = []
    for text, size in descriptions:
        placed.append(text + struct.pack(">q", begin))
        begin += size
    yield start + _listed(VARIABLE, placed)
    for _, values, _ in variables.values():
        yield _pad(values.astype(values.dtype.newbyteorder(">"), order="C", copy=False).tobytes())


def unpack(data: bytes | memoryview) -> Header:
    """The header of a file from its first bytes, which hold the whole header.

    Raises
    ------
    ValueError, struct.error, UnicodeDecodeError, IndexError, KeyError
        If the bytes are no header. The time and the memory that it takes are bounded by their number.
    """
    if bytes(data[:4]) != MAGIC:
        raise ValueError("no NetCDF file of the format CDF-5")
    reader = _Reader(data, 12)
    dims = [(reader.name(), reader.number()) for _ in reader.listed(DIMENSION)]
    attrs = reader.attributes()
    variables = {}
    for _ in reader.listed(VARIABLE):
        name = reader.name()
        axes = [dims[reader.number()] for _ in range(reader.number())]
        own = reader.attributes()
        dtype = DTYPES[reader.type()]
        reader.number()  # the size, which follows from the axes
        shape = tuple(size for _, size in axes)
        variables[name] = Stored(tuple(n for n, _ in axes), dtype, shape, reader.number(), own)
    return Header(attrs, variables)


class _Reader:
    """Reads a header from its start to its end."""

    def __init__(self, data: bytes | memoryview, at: int) -> None:
        self.data, self.at = data, at

    def number(self) -> int:
        """A number of 8 bytes."""
        (value,) = struct.unpack_from(">q", self.data, self.at)
        self.at += 8
        return int(value)

    def type(self) -> int:
        """A number of 4 bytes."""
        (value,) = struct.unpack_from(">i", self.data, self.at)
        self.at += 4
        return int(value)

    def taken(self, size: int) -> bytes:
        """So many bytes; those that fill them up to a multiple of four are passed over."""
        if not 0 <= size <= len(self.data) - self.at:
            raise ValueError(f"{size} bytes asked for where the header has fewer")
        found = bytes(self.data[self.at : self.at + size])
        self.at += _padded(size)
        return found

    def name(self) -> str:
        """A name."""
        return self.taken(self.number()).decode()

    def listed(self, tag: int) -> range:
        """The numbers of the entries of a list."""
        found, size = self.type(), self.number()
        if found not in (0, tag) or (found == 0 and size):
            raise ValueError(f"a list of the kind {found} where {tag} is due")
        return range(size)

    def attributes(self) -> dict[str, Any]:
        """A list of attributes: text, numbers and arrays of numbers by name."""
        return {self.name(): self.value() for _ in self.listed(ATTRIBUTE)}

    def value(self) -> Any:
        """The value of an attribute."""
        dtype, size = DTYPES[self.type()], self.number()
        data = self.taken(size * dtype.itemsize)
        if dtype.kind == "S":
            return data.decode()
        values = np.frombuffer(data, dtype).astype(dtype.newbyteorder("="))
        return values[0] if size == 1 else values


def attribute(name: str, value: Any) -> bytes:
    """The bytes of an attribute in a header."""
    if isinstance(value, str):
        text = value.encode()
        return _name(name) + struct.pack(">iq", TYPES["S1"], len(text)) + _pad(text)
    array = np.atleast_1d(np.asarray(value))
    if array.ndim > 1 or array.dtype.kind not in "iuf":
        raise ValueError(
            f"attribute {name}={value!r}: is neither text, nor a number, nor a list of numbers"
        )
    data = array.astype(array.dtype.newbyteorder(">")).tobytes()
    return _name(name) + struct.pack(">iq", _type(name, array), array.size) + _pad(data)


def _attributes(attrs: Mapping[str, Any]) -> bytes:
    return _listed(ATTRIBUTE, (attribute(name, value) for name, value in attrs.items()))


def _type(name: str, values: np.ndarray) -> int:
    """The number that stands for the type of values."""
    code = values.dtype.str[1:]
    if code not in TYPES:
        raise ValueError(f"{name}: has values of type {values.dtype}, which files do not hold")
    return TYPES[code]


def _listed(tag: int, entries: Iterable[bytes]) -> bytes:
    found = list(entries)
    return struct.pack(">iq", tag if found else 0, len(found)) + b"".join(found)


def _name(name: str) -> bytes:
    text = name.encode()
    return struct.pack(">q", len(text)) + _pad(text)


def _padded(size: int) -> int:
    return size + -size % 4


def _pad(data: bytes) -> bytes:
    return data + bytes(-len(data) % 4)
