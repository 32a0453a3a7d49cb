"""The log of a script that Snakemake starts, and how the script ends when it is told to."""

import atexit
import logging
import os
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import NoReturn


def log_to(path: str | Path) -> None:
    """Write all that this process and its libraries say into the file ``path``; end at once on SIGTERM.

    Standard output and standard error lead into the file from now on, line by line. `logging` writes there
    too: of granstudy all from INFO on, of other packages warnings. On SIGTERM the process leaves through
    `SystemExit`, so that files half-written are swept, and without a traceback.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    sys.stdout.flush()
    sys.stderr.flush()
    with open(path, "wb") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    sys.stdout = os.fdopen(1, "w", buffering=1, closefd=False, encoding="utf-8")
    sys.stderr = os.fdopen(2, "w", buffering=1, closefd=False, encoding="utf-8")
    logging.basicConfig(format="%(asctime)s %(message)s", datefmt="%H:%M:%S")
    logging.getLogger("granstudy").setLevel(logging.INFO)
    signal.signal(signal.SIGTERM, _leave)


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    """Leave through the stack, then without taking the interpreter apart, which takes a second or two."""
    status = 128 + number
    atexit.register(_exit, status)
    raise SystemExit(status)


def _exit(status: int) -> NoReturn:
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
