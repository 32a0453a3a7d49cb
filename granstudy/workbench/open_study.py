"""A study as an object: its runs and how they stand, its datasets, tables and figures, what is left."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.figure import draw
from granstudy.analysis.requests import check_requests
from granstudy.analysis.tables.table import experiment_table
from granstudy.datasets.collected import gather
from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.open_runs import open_runs
from granstudy.datasets.unstack import unstack_runs
from granstudy.model.identity import coordinate
from granstudy.reading.theories import theories
from granstudy.runs.estimates import estimate_run
from granstudy.study.healing import healed
from granstudy.study.jobs import seconds_of, threads_of
from granstudy.study.layout import Layout
from granstudy.study.state import State, check_owner, show
from granstudy.study.study import Member, Study, load_study
from granstudy.support.errors import unknown_name
from granstudy.support.reporter import duration
from granstudy.trust.flags import flag_word
from granstudy.trust.notice import warn_of_trust
from granstudy.workbench.compute import Failure, compute
from granstudy.workbench.tasks import RunTask

if TYPE_CHECKING:
    from distributed import Client

GATHERED_FROM = 200
"""Runs of an experiment from which on what was gathered is kept in a file."""


@dataclass(frozen=True)
class Remaining:
    """What is left of a study.

    Attributes
    ----------
    runs : int
        Runs that are not in the store.
    seconds : float
        Estimated time on one core.
    memory_mb : int
        Estimated memory of the largest of them.
    """

    runs: int
    seconds: float
    memory_mb: int


class OpenStudy:
    """A study and the results that it has; `granstudy.open_study` makes one.

    Attributes
    ----------
    name, title : str
    experiments : list of str
        Names of its experiments.
    layout : Layout
        Where its results lie.
    """

    def __init__(self, study: Study, results: str | Path, file: str | Path | None) -> None:
        self._study, self._file = study, file
        self.layout = Layout(study, str(results))
        self.name, self.title = study.name, study.model.title
        self.experiments = list(study.model.experiments)

    @property
    def _state(self) -> State:
        """How the study stands now; others may compute meanwhile."""
        return State(self.layout)

    @property
    def runs(self) -> pd.DataFrame:
        """All runs, by experiment and path: state, label, reason, estimated seconds, key.

        =========  ==========================================================
        ``state``  meaning
        =========  ==========================================================
        done       its dataset is there
        failed     its dataset says that it failed or diverged, and `reason`
        missing    not computed yet
        stale      only an older version is there: its parameters or the code
                   changed since
        =========  ==========================================================
        """
        words, rows = self._state.words(), []
        outcomes = self._outcomes()
        for m in self._study.members:
            state, label, reason = words[m.experiment, m.path], "", ""
            if m.key in outcomes:
                status, label, reason = outcomes[m.key]
                state = "done" if status == "ok" else "failed"
            seconds = estimate_run(m.run.computation).cost.seconds
            rows.append((m.experiment, m.path, state, label, reason, seconds, m.key))
        columns = ["experiment", "path", "state", "trust", "reason", "seconds", "key"]
        return pd.DataFrame(rows, columns=columns).set_index(["experiment", "path"])

    def _outcomes(self) -> dict[str, tuple[str, str, str]]:
        """Status, label and reason of each run that is there, by key."""
        found = {}
        for experiment in self.experiments:
            if self._study.is_timed(experiment) or not self._there(experiment):
                continue
            runs = self._gathered(experiment)
            keys, reasons = runs["run_key"].values.tolist(), runs["reason"].values.tolist()
            status = runs["status"].values.tolist()
            trust = runs["trust"].values.tolist() if "trust" in runs else [-1] * len(keys)
            for key, number, label, reason in zip(keys, status, trust, reasons, strict=True):
                word = flag_word("trust", label) if label >= 0 else ""
                found[key] = (flag_word("status", number), word, str(reason))
        return found

    @property
    def remaining(self) -> Remaining:
        """What is left to compute."""
        state = self._state
        costs = [estimate_run(same[0].run.computation).cost for same in state.missing]
        memory = max((cost.memory_mb for cost in costs), default=0)
        return Remaining(len(costs), state.seconds, memory)

    def compute(
        self,
        *,
        client: "Client | None" = None,
        workers: int | None = None,
        progress: bool | None = None,
    ) -> None:
        """Compute the runs that are missing or damaged, here or on a cluster, into the store.

        `snakemake` then finds them there. Benchmarks are left to `snakemake`, which gives them the machine.

        Parameters
        ----------
        client, workers, progress
            As of `granstudy.sweep`.

        Raises
        ------
        RuntimeError
            If runs could not be computed, with the cause of each; the others were.
        """
        self.layout.store.heal(member.key for member in self._study.members)
        self.show()  # so that the study has these runs, whatever becomes of this process
        tasks = [_task(same) for same in self._state.missing]
        store = self.layout.store
        try:
            found = compute(tasks, store, client=client, workers=workers, progress=progress)
        finally:
            self.show()
        causes = [f"{one.key}: {one.cause}" for one in found.values() if isinstance(one, Failure)]
        if causes:
            raise RuntimeError(
                f"{len(causes)} of {len(tasks)} runs could not be computed:\n" + "\n".join(causes)
            )

    def show(self) -> None:
        """Make the study's folder of runs show the study as it is now.

        Raises
        ------
        ValueError
            If the results of another study lie under the study's name.
        """
        check_owner(self.layout, self._file)
        show(self._state, self._file)

    def dataset(
        self,
        experiment: str | None = None,
        *,
        densities: bool = False,
        references: bool = False,
        stacked: bool = False,
    ) -> xr.Dataset:
        """The runs of an experiment that are there, over the swept parameters.

        Parameters
        ----------
        experiment : str, optional
            Its name; may be left out where the study has one experiment.
        densities : bool
            Whether kept densities are in it, read when they are used.
        references : bool
            Whether references and truths are in it; it is then over ``run``.
        stacked : bool
            Whether the runs lie over one dimension ``run``.

        Returns
        -------
        xarray.Dataset
            Of a benchmark the dataset that `snakemake` wrote.

        Raises
        ------
        ValueError
            For an unknown experiment, or one without runs yet.
        """
        name = self._named(experiment)
        if self._study.is_timed(name):
            return read_dataset(self._timed_file(name))
        there = self._there(name)
        if not there:
            raise ValueError(f"{name}: no run is there yet; study.compute(), or snakemake")
        keys = {m.key for m in there if references or not m.run.is_reference}
        if densities:
            store = self.layout.store
            runs = open_runs([store.path(key) for key in sorted(keys)], densities=True)
        else:
            gathered = self._gathered(name)
            rows = [i for i, key in enumerate(gathered["run_key"].values.tolist()) if key in keys]
            runs = gathered.isel(run=rows)
        warn_of_trust(runs)
        if stacked or references:
            return runs
        over = self._swept(name, runs)
        return unstack_runs(runs, over) if over else runs.isel(run=0)

    def _swept(self, name: str, runs: xr.Dataset) -> list[str]:
        """Coordinates of the swept parameters that differ between the runs."""
        words = dict.fromkeys(
            word for run in self._study.runs[name].values() for word, _ in run.values
        )
        names = [coordinate(word) for word in words]
        if "M_sph" in names and "N_theta" in runs.coords:
            names += ["N_theta", "N_phi"]
        names = [one for one in names if one in runs.coords and runs[one].dims == ("run",)]
        varied = [one for one in names if len(set(map(repr, runs[one].values.tolist()))) > 1]
        return varied or names[:1]

    def table(self, experiment: str | None = None) -> xr.Dataset:
        """Table of an experiment, a row a run, as `snakemake` writes it.

        Raises
        ------
        ValueError
            If runs are missing.
        """
        return self._tables([self._named(experiment)])[self._named(experiment)]

    def figure(self, experiment: str | None = None) -> Figure:
        """Figure of an experiment, as `snakemake` draws it.

        Raises
        ------
        ValueError
            If runs are missing, or the experiment asks for no figure.
        """
        name = self._named(experiment)
        model = self._study.model.experiments[name]
        beside = self._tables(model.beside_figure)
        own = self._tables([name])[name]
        runs = self._study.runs[name]
        with healed(self.layout, name):
            return draw(model, own, self.layout.run_files(name), list(beside.values()), runs)

    def _tables(self, names: Sequence[str]) -> dict[str, xr.Dataset]:
        """Tables of experiments, each after those that stand beside it."""
        found, there = {}, self._state.there
        for name in names:
            model = self._study.model.experiments[name]
            if self._study.is_timed(name):
                self._timed_file(name)
            lacking = [m for m in self._members(name) if m.key not in there]
            if lacking:
                raise ValueError(
                    f"{name}: {len(lacking)} runs are missing; study.compute(), or snakemake"
                )
            self.show()
            files, runs = self.layout.run_files(name), self._study.runs[name]
            beside = list(self._tables(model.beside_table).values())
            with healed(self.layout, name):
                found[name] = experiment_table(model, runs, files, beside)
        return found

    def theory(self, experiment: str | None = None) -> xr.Dataset:
        """What theory says of an experiment's gases, over the swept parameters (`granstudy.theory`).

        =====================  ===================================================================
        `haff_constant`        C0 of T0 (1 + C0 t)^(−2/λ), a Gaussian shape at the first T
        `cooling_state_a2`     kurtosis excess of the cooling state, linear theory
        `heated_state_a2`      that of the heated state
        `heated_temperature`   its temperature
        =====================  ===================================================================

        NaN where a law does not hold: restitution that is no constant, gases without heating, e = 1.

        Raises
        ------
        ValueError
            If no run is there yet, or the experiment's runs have no temperature.
        """
        name = self._named(experiment)
        runs = self.dataset(name)
        if "temperature" not in runs:
            kind = self._study.model.experiments[name].computes
            raise ValueError(f"{name}: {kind} runs have no temperature that a theory is of")
        return theories(runs, self._dim(name))

    def _timed_file(self, name: str) -> str:
        """Dataset of a benchmark; ValueError where there is none yet."""
        path = self.layout.benchmark_file(name)
        if not Path(path).is_file():
            raise ValueError(f"{name}: is a benchmark without timings yet; snakemake makes them")
        return path

    def _dim(self, name: str) -> int:
        return next(iter(self._study.runs[name].values())).scene.dim

    def _members(self, name: str) -> list[Member]:
        return [m for m in self._study.members if m.experiment == name]

    def _there(self, name: str) -> list[Member]:
        there = self._state.there
        return [m for m in self._members(name) if m.key in there]

    def _gathered(self, name: str) -> xr.Dataset:
        """The runs of an experiment that are there, references among them, over ``run``."""
        store, members = self.layout.store, self._there(name)
        files = {m.key: store.path(m.key) for m in members}
        kept = self.layout.gathered(name) if len(files) >= GATHERED_FROM else None
        return gather(files, kept)

    def _named(self, experiment: str | None) -> str:
        if experiment is None and len(self.experiments) == 1:
            return self.experiments[0]
        if experiment not in self.experiments:
            raise unknown_name("experiment", experiment, self.experiments)
        return experiment

    @cached_property
    def _total(self) -> int:
        return len({m.key for m in self._study.members})

    def __repr__(self) -> str:
        left = self.remaining
        lines = [f"Study {self.name!r}: {self.title}"]
        lines += [f"  {self._total - left.runs} of {self._total} runs are done"]
        if left.runs:
            lines[-1] += f"; {left.runs} left, about {duration(left.seconds)} on one core"
        for name in self.experiments:
            model = self._study.model.experiments[name]
            lines.append(f"  {name}: {model.title}; {len(self._study.runs[name])} runs")
        return "\n".join(lines)


def _task(same: Sequence[Member]) -> RunTask:
    return RunTask(same[0].run.computation, same[0].key, seconds_of([same])[0], threads_of(same))


def open_study(
    study: str | Path | Mapping[str, Any],
    *,
    name: str | None = None,
    results: str | Path = "results",
) -> OpenStudy:
    """Open a study, from its file or built in Python, with the results that it has.

    Parameters
    ----------
    study : str, Path or mapping
        The study file; or what such a file says, as a dict: ``{"title": .., "experiments": {..}}``.
    name : str, optional
        Name of a study built in Python; a study file has its own.
    results : str or Path
        Folder of the results of all studies.

    Returns
    -------
    OpenStudy

    Raises
    ------
    ValueError
        One line for each mistake in the study, with field, value and what is allowed; and if the results of
        another study lie under its name.

    Examples
    --------
    >>> study = gs.open_study("my_study.yaml")  # doctest: +SKIP
    >>> study.compute()  # doctest: +SKIP
    >>> study.dataset("cooling")["temperature"].sel(e=0.7).plot()  # doctest: +SKIP
    """
    loaded = load_study(study, name)
    file = None if isinstance(study, Mapping) else study
    check_requests(loaded, file or "")
    opened = OpenStudy(loaded, results, file)
    check_owner(opened.layout, file)
    return opened
