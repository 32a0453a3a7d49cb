"""^C: every job ends at once, and Snakemake in one line, whoever of them gets the signal.

Left to itself, Snakemake waits for all running jobs and forgets what they did, and its scripts answer ^C with
a traceback. So jobs ignore SIGINT (`SHELL_PREFIX`), and Snakemake's main process ends them by SIGTERM, which
ends a Python process in silence, also while it starts.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType, TracebackType
from typing import NoReturn

import psutil

MARK = "GRANSTUDY_JOB"
"""Environment variable of every job that Snakemake starts on this machine."""

SHELL_PREFIX = f"set -euo pipefail; trap '' INT; export {MARK}=1; "
"""Start of every job's shell command: Snakemake's usual start, no heed to ^C, and the mark."""

GRACE = 2.0
"""Seconds between SIGTERM and SIGKILL for a job."""

GOES_ON = "the same command goes on"

_stopped = threading.Event()
_said = threading.Event()


def stopped() -> bool:
    """Whether a person has stopped this process."""
    return _stopped.is_set()


def said() -> None:
    """Note that the person was told."""
    _said.set()


def install() -> None:
    """Answer SIGINT, and SIGTERM until Snakemake's scheduler answers it; in the main thread only."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, _interrupt)
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            signal.signal(signal.SIGTERM, _terminate)
        sys.excepthook = _excepthook


def _interrupt(number: int, frame: FrameType | None) -> None:
    """End all jobs, and Snakemake; what is left the second time, at any price.

    The scheduler of local jobs ends as by SIGTERM: when no job runs any more. KeyboardInterrupt would leave
    Snakemake's threads in the midst of their work; it is raised before there is such a scheduler, and where
    jobs run elsewhere, which Snakemake then cancels.
    """
    if _stopped.is_set():
        for process in _jobs():
            _kill(process)
        raise KeyboardInterrupt
    _stopped.set()
    finish = _scheduler()
    threading.Thread(target=_end_jobs, args=(finish,), name="end of jobs").start()
    if finish is None:
        raise KeyboardInterrupt


def _scheduler() -> Callable[..., object] | None:
    """The scheduler's answer to SIGTERM, which starts no more jobs; None unless it runs jobs here only."""
    answer = signal.getsignal(signal.SIGTERM)
    scheduler = getattr(answer, "__self__", None)
    if callable(answer) and getattr(getattr(scheduler, "workflow", None), "local_exec", False):
        return answer
    return None


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    """Leave through the stack, so that the lock on the working directory is taken off."""
    raise SystemExit(128 + number)


def _excepthook(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """Say in one line that a person stopped Snakemake; other errors as ever."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
    elif not _said.is_set():
        print(f"stopped: {GOES_ON}", file=sys.stderr)


def _end_jobs(finish: Callable[..., object] | None) -> None:
    """Let the scheduler finish; until this process ends, end its jobs, also those that start meanwhile."""
    if finish is not None:
        finish()  # in a thread of its own: it waits for a lock that the main thread may hold
    told: dict[psutil.Process, float] = {}
    while True:
        for process in _jobs():
            if process not in told:
                told[process] = time.monotonic()
                (_kill if _is_shell(process) else _tell)(process)
        left = [process for process in told if _lives(process)]
        for process in left:
            if time.monotonic() - told[process] > GRACE:
                _kill(process)
        if not left and not threading.main_thread().is_alive():
            return
        time.sleep(0.05)


def _jobs() -> list[psutil.Process]:
    """The processes of all jobs, each before those that it has started."""
    found: list[psutil.Process] = []
    for child in psutil.Process().children():
        with suppress(psutil.Error):
            if _is_job(child):
                found += [child, *child.children(recursive=True)]
    return found


def _is_job(process: psutil.Process) -> bool:
    """Whether a child is a job: a shell that was told so, or the script that took the shell's place."""
    return any(MARK in word for word in process.cmdline()) or MARK in process.environ()


def _is_shell(process: psutil.Process) -> bool:
    """Whether a process is a shell, which would say on the terminal that its script was terminated."""
    try:
        return process.name() in {"bash", "sh"}
    except psutil.Error:
        return False


def _lives(process: psutil.Process) -> bool:
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.Error:
        return False


def _tell(process: psutil.Process) -> None:
    """Tell a process to end, by SIGTERM; Windows ends it at once."""
    with suppress(psutil.Error, OSError):
        if process.pid != os.getpid():
            process.terminate()


def _kill(process: psutil.Process) -> None:
    """End a process, by SIGKILL."""
    with suppress(psutil.Error, OSError):
        if process.pid != os.getpid():
            process.kill()
