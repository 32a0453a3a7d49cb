"""FFTW's real transforms of a buffer, planned here and executed by compiled loops.

pyfftw executes a plan through Python, so that threads wait for the interpreter. Compiled loops call the
FFTW that pyfftw ships by name instead: a thread then sums its share of the nodes without the interpreter.
"""

import ctypes
import weakref
from collections.abc import Sequence

import llvmlite.binding
import numpy as np
import pyfftw
from numba.core import types

from granstudy.support.compiled import compiled

FORWARD, BACKWARD, SINGLE, MADE = range(4)
"""Places in an array of plans: the addresses of the two plans, whether they are in single precision, and
how many transforms they have made."""

PREFIX = {np.dtype(np.float64): "fftw", np.dtype(np.float32): "fftwf"}
"""First part of the names of FFTW's functions, by the precision of real numbers."""

FLAGS = 64 | 1
"""FFTW_ESTIMATE | FFTW_DESTROY_INPUT. The other planners give different bits from process to process, and
gain little."""

_library = ctypes.PyDLL(pyfftw.pyfftw.__file__)  # holds Python's lock: one thread at a time plans
for _prefix in PREFIX.values():
    # pyfftw plans without Python's lock.
    getattr(_library, f"{_prefix}_make_planner_thread_safe")()
    _execute = ctypes.cast(getattr(_library, f"{_prefix}_execute"), ctypes.c_void_p)
    llvmlite.binding.add_symbol(f"granstudy_{_prefix}_execute", _execute.value)

_signature = types.void(types.uintp)
_execute_double = types.ExternalFunction("granstudy_fftw_execute", _signature)
_execute_single = types.ExternalFunction("granstudy_fftwf_execute", _signature)


@compiled(forceinline=True)
def execute(plans, direction):
    """Make one transform, `FORWARD` or `BACKWARD`, of the buffer that ``plans`` were made for."""
    plans[MADE] += 1
    if plans[SINGLE]:
        _execute_single(plans[direction])
    else:
        _execute_double(plans[direction])


@compiled()
def alternate(first, first_direction, second, second_direction, count):
    """Make ``count`` pairs of transforms and nothing else, for benchmarks."""
    for _ in range(count):
        execute(first, first_direction)
        execute(second, second_direction)


def plan_in_place(spectrum: np.ndarray, nz: int) -> np.ndarray:
    """Plans of real transforms in place, on the buffer of a half spectrum (n, n', nz/2+1).

    All axes longer than 1 are transformed. The buffer must live as long as the plans.
    """
    real = spectrum.real.dtype
    half = spectrum.shape
    axes = [axis for axis, length in enumerate(half) if length > 1]
    points = _integers([(*half[:-1], nz)[axis] for axis in axes])
    padded = _integers([(*half[:-1], 2 * half[-1])[axis] for axis in axes])
    modes = _integers([half[axis] for axis in axes])
    buffer = ctypes.c_void_p(spectrum.ctypes.data)
    plans = np.zeros(4, dtype=np.uintp)
    plans[SINGLE] = real.itemsize == 4
    for direction, kind, before, after in (
        (FORWARD, "r2c", padded, modes),
        (BACKWARD, "c2r", modes, padded),
    ):
        make = getattr(_library, f"{PREFIX[real]}_plan_many_dft_{kind}")
        make.restype = ctypes.c_void_p
        # A single transform of these axes: strides 1, distance 0.
        plan = make(
            len(axes), points, 1, buffer, before, 1, 0, buffer, after, 1, 0, ctypes.c_uint(FLAGS)
        )
        plans[direction] = plan
        weakref.finalize(plans, _destroy, PREFIX[real], plan)
    return plans


def _destroy(prefix: str, plan: int) -> None:
    getattr(_library, f"{prefix}_destroy_plan")(ctypes.c_void_p(plan))


def _integers(values: Sequence[int]) -> ctypes.Array[ctypes.c_int]:
    return (ctypes.c_int * len(values))(*values)
