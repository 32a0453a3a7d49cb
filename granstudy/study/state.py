"""How far a study is: its runs that are in the store, and its folder that shows them."""

import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from granstudy.runs.execute import label_of
from granstudy.runs.run_key import rung_keys
from granstudy.runs.store import link, sidecar
from granstudy.study.jobs import Job, jobs, seconds_of
from granstudy.study.layout import Layout
from granstudy.study.study import Member
from granstudy.support.files import ABANDONED, read_json, write_json, write_text


@dataclass(frozen=True)
class State:
    """The runs of a study against its store.

    Attributes
    ----------
    layout : Layout
    """

    layout: Layout

    @cached_property
    def kept(self) -> set[str]:
        """Keys of all runs in the store."""
        return self.layout.store.keys()

    @cached_property
    def there(self) -> set[str]:
        """Keys of the study's runs that are in the store."""
        return self.kept & {member.key for member in self.layout.study.members}

    @cached_property
    def missing(self) -> list[list[Member]]:
        """Runs that are not in the store; members that are the same run are together."""
        members: dict[str, list[Member]] = {}
        for m in self.layout.study.members:
            if m.key not in self.there:
                members.setdefault(m.key, []).append(m)
        return list(members.values())

    @property
    def seconds(self) -> float:
        """Estimated time of the missing runs, on one core."""
        return sum(seconds_of(self.missing))

    def words(self) -> dict[tuple[str, str], str]:
        """How each run stands, by experiment and path: ``done``, ``missing``, or ``stale``.

        A run is stale where only an older version is there: its parameters or its code changed since.
        """
        older = self.older
        return {
            (m.experiment, m.path): (
                "done"
                if m.key in self.there
                else "stale"
                if f"{m.experiment}/{m.path}" in older
                else "missing"
            )
            for m in self.layout.study.members
        }

    @property
    def older(self) -> dict[str, str]:
        """Keys of older versions of runs, by experiment/path, where the store still has them."""
        before, found = read_json(self.layout.manifest), {}
        for m in self.layout.study.members:
            name = f"{m.experiment}/{m.path}"
            for part in ("runs", "older"):
                key = before.get(part, {}).get(name, m.key)
                if key != m.key and key in self.kept:
                    found[name] = key
        return found


def check_owner(layout: Layout, file: str | Path | None) -> None:
    """Raise ValueError where results of another study file lie under the study's name.

    A study file that is no longer there has given up its name. A study that was built in Python has no file,
    and any file's name is taken for it.
    """
    if any(character in layout.folder for character in "{}"):
        raise ValueError(f"results={layout.folder!r}: must have no braces, which Snakemake reads")
    owner = read_json(layout.manifest).get("file")
    if owner and Path(owner).is_file() and not (file and Path(file).samefile(owner)):
        raise ValueError(
            f"{file or f'study {layout.study.name!r}'}: {layout.results} holds the results of another "
            f"study, {owner}; take another name, or another folder: --config results=..."
        )


def prepare(layout: Layout, file: str | Path, cores: int | None) -> list[Job]:
    """Make a study's folder show the study as it is now, and write down the jobs that are left.

    Names of runs that the study no longer has are removed; the runs stay in the store. Runs that are in the
    store get their names, whoever computed them.

    Parameters
    ----------
    file : str or Path
        The study file.
    cores : int or None
        Cores that the jobs share; None where each job gets a machine of its own.

    Returns
    -------
    list of Job
        The longest first.
    """
    state = State(layout)
    show(state, file)
    left = jobs(state.missing, cores)
    _forget_jobs(state, {job.id for job in left})
    for job in left:
        # A receipt from when its runs were there would leave the job out.
        Path(layout.receipt(job.id)).unlink(missing_ok=True)
        job.write(Path(layout.job_file(job.id)))
    layout.store.sweep(ABANDONED, time.time())
    _write_overview(state, left, cores)
    return left


def show(state: State, file: str | Path | None) -> None:
    """Make a study's folder show the study as it is now; ``file`` is the study file, if it has one."""
    _show_runs(state, file)
    for name in state.layout.study.model.experiments:
        if not state.layout.study.is_timed(name):
            _show_complete(state, name)


def _show_runs(state: State, file: str | Path | None) -> None:
    layout, store = state.layout, state.layout.store
    before = read_json(layout.manifest)
    runs = {f"{m.experiment}/{m.path}": m.key for m in layout.study.members}
    for name, key in before.get("runs", {}).items():
        path = Path(layout.runs) / f"{name}.nc"
        if runs.get(name) != key and path.exists():
            path.unlink()
            sidecar(path).unlink(missing_ok=True)
            _remove_empty(path.parent, Path(layout.runs))
    for m in layout.study.members:
        if m.key in state.there:
            link(store.path(m.key), Path(layout.run_file(m.experiment, m.path)))
    content = {
        "study": layout.study.name,
        "file": "" if file is None else str(Path(file).resolve()),
        "runs": runs,
        "rungs": rung_keys(m.run.computation for m in layout.study.members),
        "older": state.older,
    }
    if content != before:
        write_json(layout.manifest, content)


def _remove_empty(folder: Path, top: Path) -> None:
    """Remove folders that are empty now, up to ``top``."""
    while folder != top and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent


def _show_complete(state: State, name: str) -> None:
    """Write an experiment's keys down: as complete where all its runs are there, else for later."""
    keys = {m.path: m.key for m in state.layout.study.members if m.experiment == name}
    path = Path(state.layout.complete(name))
    if not all(key in state.there for key in keys.values()):
        since = Path(state.layout.since(name))
        if path.exists() or not since.exists():
            write_text(since, str(time.time_ns()))
        path.unlink(missing_ok=True)
        write_json(Path(state.layout.awaited(name)), keys)
    elif read_json(path) != keys:
        write_json(path, keys)


def _forget_jobs(state: State, left: Iterable[str]) -> None:
    """Remove the files of jobs whose runs are all in the store, once their labels are written down."""
    layout, keep = state.layout, set(left)
    labels = read_json(layout.labels)
    for receipt in layout.jobs.glob("*.done"):
        name = receipt.stem
        job = Path(layout.job_file(name))
        labels |= read_json(receipt)
        done = not job.is_file() or all(key in state.kept for _, _, key in Job.read(job).runs)
        if name not in keep and done:
            for file in layout.jobs.glob(f"{name}.*"):
                file.unlink(missing_ok=True)
    write_json(layout.labels, labels)


def labels(state: State) -> Counter[str]:
    """How many of the runs that are there have which label (`granstudy.runs.execute.Outcome.label`)."""
    known = read_json(state.layout.labels)
    unknown = [key for key in state.there if key not in known]
    if unknown:
        known |= {key: label_of(state.layout.store.path(key)) for key in unknown}
        write_json(state.layout.labels, known)
    return Counter(known[key] for key in state.there)


def _write_overview(state: State, left: list[Job], cores: int | None) -> None:
    layout = state.layout
    content = {
        "study": layout.study.name,
        "results": layout.results,
        "runs": len({m.key for m in layout.study.members}),
        "done": len(state.there),
        "seconds": sum(job.total for job in left),
        "cores": cores or 1,
        "labels": labels(state),
        "page": layout.report,
    }
    write_json(layout.overview, content)
