"""The terminal: lines that stay, and below them lines that are drawn anew; a file gets plain lines."""

import os
import shutil
import sys
import threading
from collections.abc import Sequence
from typing import TextIO

from snakemake_logger_plugin_granstudy import text
from snakemake_logger_plugin_granstudy.session import Session

REDRAW = 1.0
"""Seconds between two drawings on a terminal."""

PLAIN = 15.0
"""Seconds between two lines of progress in a file."""

RED, USUAL = "\033[31m", "\033[0m"
CLEAR = "\033[J"


class Screen:
    """Shows a session; all writing is done under one lock.

    Attributes
    ----------
    stream : TextIO
        Where it writes.
    """

    def __init__(self, session: Session, to_stdout: bool = False, colour: bool = True) -> None:
        self.stream: TextIO = sys.stdout if to_stdout else sys.stderr
        terminal = self.stream.isatty() and os.environ.get("TERM", "dumb") != "dumb"
        self._session = session
        self._live = terminal and not session.quiet
        self._colour = terminal and colour
        self._lock = threading.RLock()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._drawn = 0
        self._said = ""

    def show(self, lines: Sequence[str]) -> None:
        """Write lines that stay."""
        if not lines:
            return
        with self._lock:
            self._erase()
            for line in lines:
                red = self._colour and line.startswith("FAILED")
                self._write(f"{RED}{line}{USUAL}\n" if red else f"{line}\n")
            if self._thread is not None and not self._ended.is_set():
                self._draw(self._block())
            self.stream.flush()

    def start(self) -> None:
        """Begin to show progress, where it was not begun."""
        if self._thread is None and not self._session.quiet:
            self._thread = threading.Thread(target=self._follow, name="progress", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """Show no progress any more."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join()
        with self._lock:
            self._erase()
            self.stream.flush()

    def abandon(self, reason: str) -> None:
        """Say why nothing more will be shown here."""
        self._ended.set()
        with self._lock:
            self._erase()
            self._live = False
            self._write(f"{reason}\n")
            self.stream.flush()

    def _follow(self) -> None:
        """Show progress until the end; a fault ends the showing and nothing else."""
        try:
            while not self._ended.wait(REDRAW if self._live else PLAIN):
                with self._lock:
                    if self._live:
                        self._erase()
                        self._draw(self._block())
                    elif (line := self._line()) != self._said:
                        self._write(f"{line}\n")
                        self._said = line
                    self.stream.flush()
        except Exception as error:
            self.abandon(f"progress is shown no more ({error!r}); the study goes on")

    def _block(self) -> list[str]:
        """The live lines at present."""
        study = self._session.now()
        if study is None or not self._live:
            return []
        starting, making = self._session.starting(study), self._session.making
        return text.block(study, starting, making, shutil.get_terminal_size().columns - 1)

    def _line(self) -> str:
        """The line of progress at present; as it was where nothing is known."""
        study = self._session.now()
        return self._said if study is None else text.head(study)

    def _draw(self, lines: list[str]) -> None:
        """Draw the live lines below what stays."""
        for line in lines:
            self._write(f"{line}\n")
        self._drawn = len(lines)

    def _erase(self) -> None:
        if self._drawn:
            self._write(f"\033[{self._drawn}F{CLEAR}")
            self._drawn = 0

    def _write(self, line: str) -> None:
        """Write, with what the terminal's encoding lacks replaced."""
        encoding = self.stream.encoding or "utf-8"
        self.stream.write(line.encode(encoding, errors="replace").decode(encoding))
