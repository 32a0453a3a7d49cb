"""Snakemake's screen for studies: runs in place of jobs, the time that is left, and what failed and why.

`snakemake --logger granstudy`, which `profiles/default` sets. Snakemake imports this package at every start,
also for other workflows, so that it imports nothing of granstudy.
"""

from logging import Handler, LogRecord
from typing import Any

from snakemake_interface_logger_plugins.base import LogHandlerBase

from snakemake_logger_plugin_granstudy import interrupt
from snakemake_logger_plugin_granstudy.screen import Screen
from snakemake_logger_plugin_granstudy.session import Session


class LogHandler(LogHandlerBase):
    """Takes the records of Snakemake's log; a fault of its own hands the rest to Snakemake's own screen."""

    def __post_init__(self) -> None:
        """Start at once, so that ^C is answered in a line from here on."""
        interrupt.install()
        settings: Any = self.common_settings
        quiet = {getattr(word, "name", "").lower() for word in settings.quiet or ()}
        self._plain: Handler | None = None
        self._closed = False
        self._session = Session(
            dry_run=settings.dryrun,
            whole_logs=settings.show_failed_logs,
            quiet=bool(quiet & {"progress", "all"}),
        )
        self._screen = Screen(self._session, to_stdout=settings.stdout, colour=not settings.nocolor)
        if settings.verbose or settings.debug_dag:
            self._plain = self._snakemakes_own()

    def emit(self, record: LogRecord) -> None:
        """Show what a record says."""
        if self._plain is None:
            try:
                self._screen.show(self._session.take(record))
                if self._session.running:
                    self._screen.start()
                return
            except Exception as error:
                self._give_up(error)
        if self._plain is not None:
            self._plain.handle(record)

    def close(self) -> None:
        """Say how the study ended; Snakemake calls this twice."""
        if self._plain is None and not self._closed:
            self._closed = True
            try:
                self._screen.stop()
                self._screen.show(self._session.end())
            except Exception as error:
                self._give_up(error)
        super().close()

    def _give_up(self, error: Exception) -> None:
        """Leave the rest to Snakemake's own screen."""
        self._plain = self._snakemakes_own()
        self._screen.abandon(f"the screen of granstudy failed ({error!r}): Snakemake's own follows")

    def _snakemakes_own(self) -> Handler:
        from snakemake.logging import ColorizingTextHandler, DefaultFormatter  # imported by now

        settings: Any = self.common_settings
        formatter = DefaultFormatter(settings.quiet, settings.show_failed_logs)
        return ColorizingTextHandler(settings.nocolor, self._screen.stream, formatter)

    @property
    def writes_to_stream(self) -> bool:
        """It writes to the terminal, in place of Snakemake's own handler."""
        return True

    @property
    def writes_to_file(self) -> bool:
        """It writes no file."""
        return False

    @property
    def has_filter(self) -> bool:
        """Snakemake's own filter is used, so that ``--quiet`` means what it does elsewhere."""
        return False

    @property
    def has_formatter(self) -> bool:
        """Lines are made here."""
        return True

    @property
    def needs_rulegraph(self) -> bool:
        """No graph is needed."""
        return False


__all__ = ["LogHandler"]
