"""Cores, memory and BLAS threads of the machine that this process may use."""

import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from threadpoolctl import ThreadpoolController

from granstudy.support.checks import LARGEST

CPUINFO = Path("/proc/cpuinfo")
"""Where Linux describes its processors, one after the other."""

CPU_MODEL = (
    "vendor_id",
    "cpu family",
    "model",
    "model name",
    "stepping",
    "CPU implementer",
    "CPU part",
)
"""What the description of a processor has of its model, on x86 and on ARM."""

CGROUP = Path("/sys/fs/cgroup")
"""Where Linux says what a group of processes may use: a container's, a job's."""


def cores() -> int:
    """Cores that this process may use; where the platform does not say, all of the machine."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def cpu_model() -> str:
    """Model of this machine's processor, as the system describes it."""
    described = {}
    with suppress(OSError):
        for line in CPUINFO.read_text().partition("\n\n")[0].splitlines():
            name, _, value = line.partition(":")
            described[name.strip()] = value.strip()
    known = [described[name] for name in CPU_MODEL if name in described]
    return " ".join(known or [platform.machine(), platform.processor()])


def memory() -> int | None:
    """Bytes of memory that this process may use: the machine's, or its group's; None where none is said."""
    if not hasattr(os, "sysconf"):  # on Windows
        return None
    sizes = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    with suppress(OSError):
        own = Path("/proc/self/cgroup").read_text().rpartition("::/")[2].strip()
        for folder in (CGROUP / own, *(CGROUP / own).parents):
            with suppress(OSError, ValueError):  # "max" is no limit
                sizes.append(int((folder / "memory.max").read_text()))
    return min(sizes)


def check_memory(what: str, needed: float, remedy: str) -> None:
    """Raise ValueError, before anything is allocated, for more bytes than this process may use.

    Parameters
    ----------
    what : str
        Field and value, ``M_cir=100000000``.
    needed : float
        Estimated bytes.
    remedy : str
        What to take in its place.
    """
    allowed = memory()
    if allowed is not None and needed > allowed:
        needed = min(needed, LARGEST)  # an integer may be beyond the largest float
        raise ValueError(
            f"{what}: takes about {needed / 1e9:.3g} GB of memory, and there are {allowed / 1e9:.3g} GB; "
            f"{remedy}"
        )


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """BLAS on one thread meanwhile: ``@one_blas_thread()`` above a function, or ``with one_blas_thread():``.

    A run has threads of its own. Where cores are busy, BLAS's threads wait for each other: derivatives of 48³
    points took 24 ms for 0.2 ms (*measured*, six processes on two cores). Digits of a sum by BLAS depend on
    the number of its threads, too.
    """
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> ThreadpoolController:
    """The libraries with threads that this process has loaded; found once, which takes milliseconds."""
    return ThreadpoolController()
