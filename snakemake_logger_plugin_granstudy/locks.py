"""Snakemake's lock on the working directory, taken off after a crash.

Snakemake writes its lock as files, which outlive a process that is killed; `--unlock` is then asked of the
user. A lock of the operating system does not: it tells a dead Snakemake from a living one.
"""

import socket
from contextlib import suppress
from pathlib import Path
from typing import TextIO

try:
    from fcntl import LOCK_EX, LOCK_NB, LOCK_SH, flock
except ImportError:  # Windows, where `snakemake --unlock` takes off a lock
    HAS_LOCKS = False
else:
    HAS_LOCKS = True

_held: list[TextIO] = []
"""The open file whose lock says, until this process ends, that it lives."""


def clear_stale(folder: Path = Path(".snakemake")) -> bool:
    """Remove the lock that a dead Snakemake of this host left; returns whether there was one.

    To be called before Snakemake locks the directory. From now on this process counts as living. Where
    another one lives, or the platform or its file system knows no such locks, nothing is removed.
    """
    if not HAS_LOCKS:
        return False
    folder.mkdir(exist_ok=True)
    file = open(folder / "granstudy.alive", "a+", encoding="utf-8")  # noqa: SIM115  stays open
    _held.append(file)
    try:
        flock(file, LOCK_EX | LOCK_NB)  # fails where anyone holds it, shared or not
    except OSError:
        _share(file)
        return False
    file.seek(0)
    before, here = file.read(), socket.gethostname()
    stale = list((folder / "locks").glob("*.lock")) if before == here else []
    for lock in stale:
        lock.unlink(missing_ok=True)
    file.truncate(0)
    file.write(here)
    file.flush()
    _share(file)
    return bool(stale)


def _share(file: TextIO) -> None:
    """Hold the lock together with others that live."""
    with suppress(OSError):
        flock(file, LOCK_SH)
