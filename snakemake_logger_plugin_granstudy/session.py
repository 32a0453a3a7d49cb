"""Records of Snakemake's log, one after the other, turned into lines for the screen."""

import logging
import re
import time as clock
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_granstudy import interrupt, text
from snakemake_logger_plugin_granstudy.overview import Now, now, read_overview

NOTHING = "Nothing to be done"

HIDDEN = (
    "Building DAG of jobs",
    "Using shell:",
    "Provided cores:",
    "Provided resources:",
    "Rules claiming more threads",
    "Conda environments: ignored",
    "Singularity containers: ignored",
    "Select jobs to execute",
    "Assuming unrestricted shared filesystem",
    "host:",
    "Job stats:",
    "Removing output files of failed job",
    "Shutting down, this might take",
    "Exiting because a job execution failed",
    "Terminating processes on user request",
    "Complete log",
    "Elapsed time",
    "Finished jobid:",
)
"""Beginnings of Snakemake's messages that say nothing to the user of a study, or what is said otherwise."""

TOLD_OTHERWISE = ("returned non-zero exit status", "At least one job did not complete successfully")
"""Parts of errors that only repeat that a job failed: the job itself is shown, with its log."""

MEMORY = {"SIGKILL": ": the machine may have run out of memory"}
"""What a signal that nobody here sent may mean."""

QUIET_EVENTS = {
    LogEvent.WORKFLOW_STARTED, LogEvent.SHELLCMD, LogEvent.JOB_STARTED, LogEvent.PROGRESS,
    LogEvent.RESOURCES_INFO, LogEvent.RULEGRAPH, LogEvent.GROUP_INFO, LogEvent.GROUP_ERROR,
    LogEvent.DEBUG_DAG,
}  # fmt: skip
"""Events without a line: what they tell is said by others."""


@dataclass
class Step:
    """A job of Snakemake.

    Attributes
    ----------
    name : str
    job : str
        Identity of a job of runs; "" for another step, such as a table.
    wanted : bool
        Whether it makes anything; the rule ``all`` does not.
    """

    name: str
    job: str
    wanted: bool


class Session:
    """One call of Snakemake.

    Parameters
    ----------
    dry_run : bool
        Whether nothing is to be done but said.
    whole_logs : bool
        Whether logs of failed jobs are shown whole.
    quiet : bool
        Whether no progress is to be shown.
    """

    def __init__(
        self, dry_run: bool = False, whole_logs: bool = False, quiet: bool = False
    ) -> None:
        self.dry_run, self.quiet = dry_run, quiet
        self.running = False
        self._whole_logs = whole_logs
        self._since = clock.time() - 1.0
        self._steps: dict[int, Step] = {}
        self._active: dict[int, Step] = {}
        self._made: list[str] = []
        self._failed: dict[str, str] = {}
        self._known: dict[Path, tuple[int, Any]] = {}
        self._nothing = self._tabled = False

    def take(self, record: logging.LogRecord) -> list[str]:
        """The lines that a record is worth."""
        event = getattr(record, "event", None)
        if event == LogEvent.RUN_INFO:
            return self._planned(record)
        if event == LogEvent.JOB_INFO:
            return self._started(record)
        if event == LogEvent.JOB_FINISHED:
            return self._finished(record)
        if event == LogEvent.JOB_ERROR:
            return self._broken(record)
        if event in QUIET_EVENTS:
            return []
        return self._message(record)

    def now(self) -> Now | None:
        """The study at present; None where no overview was written."""
        found = read_overview()
        if found is None:
            return None
        overview, path = found
        return now(overview, self._progress(path.parent), self._since, clock.time())

    @property
    def making(self) -> list[str]:
        """Steps that run now and are no jobs of runs."""
        return [step.name for step in list(self._active.values()) if step.wanted and not step.job]

    def starting(self, study: Now) -> int:
        """Number of jobs of runs that run now and have not yet told where they are."""
        told = {job.job for job in study.jobs}
        return len({step.job for step in list(self._active.values()) if step.job} - told)

    def end(self) -> list[str]:
        """The last lines of a call."""
        stopped = interrupt.stopped()
        if stopped:
            interrupt.said()
        study = self.now() if (self.running or self._nothing) and not self.dry_run else None
        if study is not None:
            failed = list(self._failed.values())
            page = study.overview.page
            there = page if not stopped and page and Path(page).is_file() else ""
            return text.ending(study, self._made, failed, stopped, interrupt.GOES_ON, there)
        return [f"stopped: {interrupt.GOES_ON}"] if stopped else []

    def _planned(self, record: logging.LogRecord) -> list[str]:
        """The table of jobs: of interest in a dry run only."""
        if self.dry_run:
            first, self._tabled = not self._tabled, True
            return [record.getMessage()] if first else []
        self.running = True
        study = self.now()
        return [] if study is None or self.quiet else [text.beginning(study)]

    def _started(self, record: Any) -> list[str]:
        """Note a job that starts; a dry run says it in a line."""
        wildcards = " ".join(str(value) for value in dict(record.wildcards or {}).values())
        name = record.rule_msg or f"{record.rule_name} {wildcards}".strip()
        jobs = [path.stem for path in map(Path, record.output) if path.parent.name == "jobs"]
        step = Step(name, "".join(jobs[:1]), bool(record.output))
        self._steps[record.jobid] = self._active[record.jobid] = step
        return [f"job {record.jobid}  {name}"] if self.dry_run and step.wanted else []

    def _finished(self, record: Any) -> list[str]:
        step = self._active.pop(record.job_id, None)
        self._failed.pop(record.job_id, None)  # it was tried again
        if step is None or step.job or not step.wanted:
            return []
        self._made.append(step.name)
        return [] if self.quiet else [f"made  {step.name}"]

    def _broken(self, record: Any) -> list[str]:
        """A failed job: once, and not at all where a person stopped it."""
        if interrupt.stopped():
            return []
        step = self._active.pop(record.jobid, None) or self._steps.get(record.jobid)
        name = step.name if step else record.rule_name
        if self._failed.get(record.jobid) == name:
            return []
        self._failed[record.jobid] = name
        remarks = [f"{key}: {value}" for key, value in (record.aux or {}).items()]
        remarks += [record.rule_msg] if record.rule_msg else []
        return text.error(name, record.log, self._whole_logs, remarks)

    def _message(self, record: logging.LogRecord) -> list[str]:
        """Any other message, unless it is known to say nothing."""
        message = record.getMessage().strip()
        if interrupt.stopped():
            return []  # what Snakemake says while it ends; the last line says the rest
        if message.startswith(NOTHING):
            self._nothing = True
        if record.levelno >= logging.ERROR:
            if any(known in message for known in TOLD_OTHERWISE):
                return []
            if killed := re.search(r"died with <Signals\.(\w+)", message):
                return [f"a job was ended by {killed[1]}{MEMORY.get(killed[1], '')}"]
        if message in {"", "None"} or message.startswith(HIDDEN) or record.levelno < logging.INFO:
            return []
        return message.splitlines()

    def _progress(self, folder: Path) -> list[Any]:
        """Progress of all jobs; a file that has not changed is not read again."""
        # Imported here: Snakemake loads this module at each start, granstudy with the Snakefile.
        from granstudy.support.reporter import SUFFIX, read_progress_file

        found: dict[Path, tuple[int, Any]] = {}
        for path in sorted(folder.glob(f"*{SUFFIX}")):
            try:
                changed = path.stat().st_mtime_ns
            except OSError:
                continue
            known = self._known.get(path)
            found[path] = (
                known if known and known[0] == changed else (changed, read_progress_file(path))
            )
        self._known = found
        return [progress for _, progress in found.values() if progress is not None]
