"""Making wisdom: PATIENT plans of the shapes that grids have, and what they gain over ESTIMATE's."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from filelock import FileLock

from granstudy.collision.fourier import fftw
from granstudy.collision.fourier.transforms import REAL, aligned_zeros
from granstudy.collision.fourier.wisdom import Wisdom, keep, kept, shape_name, wisdom_path

FACTORS = (2, 3, 5, 7, 11, 13)
"""Prime factors of the sizes that are tuned: FFTW has code for these, and is slow at all others."""

LARGEST = {2: 256, 3: 64}
"""Most points per dimension that are tuned unless asked for more, by the number of dimensions."""

ROUNDS = 9
ROUND_SECONDS = 4.0e-3
"""Both kinds of plans are timed in turn, in so many rounds of about so long each."""

Shape = tuple[int, int, int]


@dataclass(frozen=True)
class Gain:
    """What patience gained for one shape: seconds of a transform and its inverse, by planner."""

    name: str
    estimate: float
    patient: float

    @property
    def ratio(self) -> float:
        """How many times as fast the PATIENT plans are."""
        return self.estimate / self.patient


def shapes(largest: int | None = None) -> list[Shape]:
    """Shapes of grids in 2D and 3D with an even number of points whose prime factors are small.

    Parameters
    ----------
    largest : int, optional
        Most points per dimension in 3D, by default `LARGEST`; in 2D it is not below `LARGEST`.
    """
    most = LARGEST if largest is None else {2: max(largest, LARGEST[2]), 3: largest}
    return [
        (n, n if dim == 3 else 1, n)
        for dim, limit in most.items()
        for n in range(6, limit + 1, 2)
        if _is_smooth(n)
    ]


@contextmanager
def tuning(anew: bool = False) -> Iterator[dict[str, str]]:
    """Wisdom to add to, by `shape_name`; it is kept where the block ends well.

    Another process that tunes meanwhile waits, and then finds what this one kept.

    Parameters
    ----------
    anew : bool
        Start from nothing, not from what was kept.
    """
    path = wisdom_path()
    path.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(path.with_suffix(".lock")):
        before = Wisdom() if anew else kept()
        texts = dict(before.texts)
        yield texts
        if texts != before.texts:
            keep(Wisdom(texts))


def tune(texts: dict[str, str], wanted: Sequence[Shape], precision: str) -> Iterator[Gain]:
    """Add the wisdom of some shapes, and say of each what it gained; shapes that are there are left out."""
    for shape in wanted:
        spectrum = _spectrum(shape, precision)
        name = shape_name(spectrum, shape[2])
        if name not in texts:
            with fftw.no_wisdom():
                quick = fftw.make_plans(spectrum, shape[2], fftw.ESTIMATE)
            with fftw.no_wisdom():
                best = fftw.make_plans(spectrum, shape[2], fftw.PATIENT)
                texts[name] = fftw.exported_wisdom(REAL[precision])
            assert quick is not None and best is not None
            yield Gain(name, *pair_seconds([quick, best], spectrum))


def pair_seconds(plans: Sequence[fftw.Plans], spectrum: np.ndarray) -> list[float]:
    """Least seconds of a transform and its inverse by each of some plans, timed in turn on one buffer.

    Seconds are this thread's own: what other processes take of its core does not count.
    """
    spectrum[...] = 0.0
    ways = [fftw.for_buffer(one, spectrum) for one in plans]
    counts, taken = [1] * len(ways), [list[float]() for _ in ways]
    for turn in range(ROUNDS + 1):
        for i, way in enumerate(ways):
            begin = time.thread_time()
            fftw.alternate(way, fftw.BACKWARD, way, fftw.FORWARD, counts[i])
            each = (time.thread_time() - begin) / counts[i]
            if turn == 0:  # warm up, and see how long it takes
                counts[i] = max(1, round(ROUND_SECONDS / max(each, 1e-7)))
            else:
                taken[i].append(each)
    return [min(times) for times in taken]


def _spectrum(shape: Shape, precision: str) -> np.ndarray:
    nx, ny, nz = shape
    return aligned_zeros((nx, ny, nz // 2 + 1), np.result_type(REAL[precision], np.complex64))


def _is_smooth(n: int) -> bool:
    for factor in FACTORS:
        while n % factor == 0:
            n //= factor
    return n == 1
