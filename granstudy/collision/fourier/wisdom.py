"""Wisdom of FFTW: plans that were found once on this machine, and are the same in every process.

Planning by ESTIMATE is a guess, up to five times slower than the best plan. PATIENT times thousands of plans
and takes the fastest, another one each time, so that results would differ in round-off from process to
process. `granstudy tune` does that once and keeps what it found, each shape for itself. Every process then
takes the plans that were kept, and ESTIMATE's for other shapes.
"""

import hashlib
import json
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path

import numpy as np

from granstudy.collision.fourier import fftw
from granstudy.collision.fourier.threads import planning
from granstudy.support.cache import cache_folder
from granstudy.support.files import sealed, unsealed, write_whole
from granstudy.support.machine import cpu_model

DIGITS = 16
"""Hexadecimal digits of a hash."""


@dataclass(frozen=True)
class Wisdom:
    """What FFTW knows of each shape: its wisdom as text, by `shape_name`."""

    texts: dict[str, str] = field(default_factory=dict)

    @cached_property
    def digest(self) -> str:
        """Hash over all of it; "" where there is none. Equal hashes mean equal plans, hence equal bits."""
        if not self.texts:
            return ""
        return hashlib.sha256(_content(self)).hexdigest()[:DIGITS]


class Planner:
    """Plans of every shape, each made once, from wisdom where there is some and else by ESTIMATE.

    A plan depends on the shape and its wisdom alone: on nothing that the process planned before.
    """

    def __init__(self, wisdom: Wisdom) -> None:
        self.wisdom = wisdom
        self._made: dict[str, fftw.Plans] = {}

    def plans(self, spectrum: np.ndarray, nz: int) -> fftw.Plans:
        """Plans for buffers like that of a half spectrum (n, n', nz/2+1)."""
        name = shape_name(spectrum, nz)
        with planning:
            if name not in self._made:
                self._made[name] = self._make(spectrum, nz, self.wisdom.texts.get(name))
            return self._made[name]

    def _make(self, spectrum: np.ndarray, nz: int, known: str | None) -> fftw.Plans:
        if known is not None:
            with fftw.no_wisdom():
                fftw.import_wisdom(known, spectrum.real.dtype)
                plans = fftw.make_plans(spectrum, nz, fftw.PATIENT | fftw.WISDOM_ONLY)
            if plans is not None:
                return plans
            warnings.warn(
                f"FFTW does not take its wisdom for {shape_name(spectrum, nz)} points and plans by "
                "ESTIMATE; `granstudy tune --anew` makes new wisdom",
                stacklevel=4,
            )
        with fftw.no_wisdom():
            plans = fftw.make_plans(spectrum, nz, fftw.ESTIMATE)
        assert plans is not None
        return plans


_current: list[Planner] = []
"""The planner of this process, once it has one."""


def planner() -> Planner:
    """The planner of this process, with the wisdom that this machine had when the process first planned."""
    with planning:
        if not _current:
            _current.append(Planner(kept()))
        return _current[0]


@contextmanager
def planning_with(wisdom: Wisdom) -> Iterator[None]:
    """Plan with this wisdom meanwhile, for comparisons; what was planned before stays as it is."""
    before = list(_current)
    _current[:] = [Planner(wisdom)]
    try:
        yield
    finally:
        _current[:] = before


def kept() -> Wisdom:
    """The wisdom that was kept on this machine. None of it in a damaged file, with a warning."""
    try:
        path = wisdom_path()
        content = path.read_bytes()
    except OSError:
        return Wisdom()
    payload = unsealed(content, machine())
    if payload is None:
        warnings.warn(
            f"{path}: damaged, or of another machine; FFTW plans by ESTIMATE. `granstudy tune --anew` makes "
            "the file anew",
            stacklevel=2,
        )
        return Wisdom()
    return Wisdom(json.loads(payload))


def keep(wisdom: Wisdom) -> None:
    """Keep wisdom for all processes that start from now on, whole or not at all."""
    content = sealed(_content(wisdom), machine())
    write_whole(wisdom_path(), lambda partial: partial.write_bytes(content))


def wisdom_path() -> Path:
    """File of the wisdom that is good for this machine: FFTW's version and the CPU's model name it.

    Plans are of one thread, so that the number of threads plays no part.

    Raises
    ------
    OSError
        If there is no cache folder.
    """
    name = hashlib.sha256(machine().encode()).hexdigest()[:DIGITS]
    return cache_folder() / f"fftw-{name}.wisdom"


@cache
def machine() -> str:
    """All that decides whether wisdom is good here: versions of pyfftw and FFTW, and the CPU's model."""
    return f"pyfftw {version('pyfftw')}, {fftw.version()}, {cpu_model()}"


def shape_name(spectrum: np.ndarray, nz: int) -> str:
    """Precision and points of a transform, as ``double 32x32x32``."""
    precision = "single" if spectrum.real.dtype.itemsize == 4 else "double"
    return f"{precision} {'x'.join(map(str, (*spectrum.shape[:-1], nz)))}"


def _content(wisdom: Wisdom) -> bytes:
    return json.dumps(wisdom.texts, sort_keys=True).encode()
