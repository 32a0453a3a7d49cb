"""A bound on the memory and the time that a call may take."""

import resource
import signal
from contextlib import contextmanager
from pathlib import Path

ROOM = 2**30
"""Bytes that the process may grow by."""

HANGS = 300
"""Seconds after which a call counts as one that never ends."""


@contextmanager
def bounded(room=ROOM, seconds=HANGS):
    """Raise where the process grows by more than ``room`` bytes, or takes longer than so many seconds."""

    def stop(number, frame):
        raise TimeoutError(f"more than {seconds} seconds")

    limits = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + room, limits[1]))
    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
        resource.setrlimit(resource.RLIMIT_AS, limits)
