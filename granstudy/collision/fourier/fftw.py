"""FFTW's real transforms of a buffer, planned here and executed by compiled loops.

pyfftw executes a plan through Python, so that threads wait for the interpreter. Compiled loops call the
FFTW that pyfftw ships by name instead: a thread then sums its share of the nodes without the interpreter.
"""

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import llvmlite.binding
import numpy as np
import pyfftw
from numba.core import types

from granstudy.collision.fourier.threads import planning
from granstudy.support.compiled import compiled

FORWARD, BACKWARD, SINGLE, BUFFER, MADE = range(5)
"""Places in an array of plans: the addresses of the two plans, whether they are in single precision, the
address of the buffer, and how many transforms were made of it."""

PREFIX = {np.dtype(np.float64): "fftw", np.dtype(np.float32): "fftwf"}
"""First part of the names of FFTW's functions, by the precision of real numbers."""

ESTIMATE, PATIENT, WISDOM_ONLY = 1 << 6, 1 << 5, 1 << 21
"""FFTW's planners: a guess, which is the same in every process; the fastest of thousands that are timed,
which is another one each time; and the plan that wisdom holds, or none."""

DESTROY_INPUT = 1
"""FFTW's flag for plans that may overwrite what they transform."""

_library = ctypes.PyDLL(pyfftw.pyfftw.__file__)  # holds Python's lock: one thread at a time plans
for _prefix in PREFIX.values():
    # pyfftw plans without Python's lock.
    getattr(_library, f"{_prefix}_make_planner_thread_safe")()
    for _kind in ("r2c", "c2r"):
        _execute = ctypes.cast(getattr(_library, f"{_prefix}_execute_dft_{_kind}"), ctypes.c_void_p)
        llvmlite.binding.add_symbol(f"granstudy_{_prefix}_{_kind}", _execute.value)

_signature = types.void(types.uintp, types.uintp, types.uintp)
_forward_double = types.ExternalFunction("granstudy_fftw_r2c", _signature)
_backward_double = types.ExternalFunction("granstudy_fftw_c2r", _signature)
_forward_single = types.ExternalFunction("granstudy_fftwf_r2c", _signature)
_backward_single = types.ExternalFunction("granstudy_fftwf_c2r", _signature)


class Plans(NamedTuple):
    """Addresses of FFTW's plans of a real transform in place, and of its inverse.

    They serve every buffer of the shape that begins at the start of a cache line. They are never destroyed:
    a process plans each of its few shapes once.
    """

    forward: int
    backward: int


@compiled(forceinline=True)
def execute(plans, direction):
    """Make one transform, `FORWARD` or `BACKWARD`, of the buffer that ``plans`` belong to."""
    plans[MADE] += 1
    buffer = plans[BUFFER]
    if direction == FORWARD:
        if plans[SINGLE]:
            _forward_single(plans[FORWARD], buffer, buffer)
        else:
            _forward_double(plans[FORWARD], buffer, buffer)
    elif plans[SINGLE]:
        _backward_single(plans[BACKWARD], buffer, buffer)
    else:
        _backward_double(plans[BACKWARD], buffer, buffer)


@compiled()
def alternate(first, first_direction, second, second_direction, count):
    """Make ``count`` pairs of transforms and nothing else, for benchmarks."""
    for _ in range(count):
        execute(first, first_direction)
        execute(second, second_direction)


def for_buffer(plans: Plans, spectrum: np.ndarray) -> np.ndarray:
    """Plans as `execute` takes them, for one buffer, which must live as long as they are used."""
    array = np.zeros(5, dtype=np.uintp)
    array[FORWARD], array[BACKWARD] = plans
    array[SINGLE] = spectrum.real.dtype.itemsize == 4
    array[BUFFER] = spectrum.ctypes.data
    return array


def make_plans(spectrum: np.ndarray, nz: int, planner: int) -> Plans | None:
    """Plan real transforms in place on the buffer of a half spectrum (n, n', nz/2+1).

    All axes longer than 1 are transformed. `PATIENT` overwrites the buffer.

    Returns
    -------
    Plans or None
        None where the planner is `WISDOM_ONLY` and wisdom has no such plan.
    """
    real = spectrum.real.dtype
    half = spectrum.shape
    axes = [axis for axis, length in enumerate(half) if length > 1]
    points = _integers([(*half[:-1], nz)[axis] for axis in axes])
    padded = _integers([(*half[:-1], 2 * half[-1])[axis] for axis in axes])
    modes = _integers([half[axis] for axis in axes])
    buffer = ctypes.c_void_p(spectrum.ctypes.data)
    flags = ctypes.c_uint(planner | DESTROY_INPUT)
    made = []
    for kind, before, after in (("r2c", padded, modes), ("c2r", modes, padded)):
        make = getattr(_library, f"{PREFIX[real]}_plan_many_dft_{kind}")
        make.restype = ctypes.c_void_p
        # A single transform of these axes: strides 1, distance 0.
        plan = make(len(axes), points, 1, buffer, before, 1, 0, buffer, after, 1, 0, flags)
        if plan is None:
            return None
        made.append(plan)
    return Plans(*made)


@contextmanager
def no_wisdom() -> Iterator[None]:
    """Plan as in a new process: FFTW knows nothing of earlier plans, takes one thread and all its time.

    What it knew, and what others use, is there again afterwards. One thread at a time plans like this.
    """
    with planning:
        known = pyfftw.export_wisdom()
        pyfftw.forget_wisdom()
        for prefix in PREFIX.values():
            getattr(_library, f"{prefix}_plan_with_nthreads")(1)
            getattr(_library, f"{prefix}_set_timelimit")(ctypes.c_double(-1.0))
        try:
            yield
        finally:
            pyfftw.forget_wisdom()
            pyfftw.import_wisdom(known)


def import_wisdom(wisdom: str, real: np.dtype) -> bool:
    """Give FFTW wisdom in one precision; False where it is none of this FFTW's."""
    read = getattr(_library, f"{PREFIX[real]}_import_wisdom_from_string")
    return bool(read(wisdom.encode()))


def exported_wisdom(real: np.dtype) -> str:
    """FFTW's wisdom in one precision."""
    return str(pyfftw.export_wisdom()[list(PREFIX).index(real)].decode())


def version() -> str:
    """Name, version and instruction sets of FFTW, as it says itself."""
    text = ctypes.c_char.in_dll(_library, "fftw_version")
    return ctypes.string_at(ctypes.addressof(text)).decode()


def _integers(values: Sequence[int]) -> ctypes.Array[ctypes.c_int]:
    return (ctypes.c_int * len(values))(*values)
