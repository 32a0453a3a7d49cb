"""Studies: from a study file to its checked runs."""

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from granstudy.datasets.parameters import parameter
from granstudy.model.identity import coordinate
from granstudy.runs.kinds import KINDS
from granstudy.runs.run_key import run_keys
from granstudy.study.checks import check_run
from granstudy.study.run import Run
from granstudy.study.schema.experiment import (
    BenchmarkExperiment,
    Experiment,
    TimingModel,
)
from granstudy.study.schema.file import StudyFile, read_study_file, study_model
from granstudy.study.schema.names import check_run_path
from granstudy.study.schema.sweeps import values_of
from granstudy.study.schema.values import cut
from granstudy.study.schema.words import place
from granstudy.support.errors import unknown_name


class Member(NamedTuple):
    """A run of a study: its experiment, its path there, and its key."""

    experiment: str
    path: str
    run: Run
    key: str


@dataclass(frozen=True)
class Study:
    """A study file and its runs.

    Attributes
    ----------
    name : str
        The file's name, without its ending.
    model : StudyFile
    runs : dict of dict of Run
        By experiment, then by path, references among them.
    """

    name: str
    model: StudyFile
    runs: dict[str, dict[str, Run]]

    def run(self, experiment: str, path: str) -> Run:
        """The run of that name, or ValueError where the study has none."""
        try:
            return self.runs[experiment][path]
        except KeyError:
            raise ValueError(
                f"study {self.name!r} has no run {experiment}/{path}: add its value to a sweep list"
            ) from None

    def is_timed(self, experiment: str) -> bool:
        """Whether an experiment's runs are computed together, into one file."""
        return KINDS[self.model.experiments[experiment].computes].compute is None

    @cached_property
    def members(self) -> list[Member]:
        """All runs that are computed one by one, each with its key."""
        found = [
            (experiment, path, run)
            for experiment, runs in self.runs.items()
            if not self.is_timed(experiment)
            for path, run in runs.items()
        ]
        keys = run_keys([run.computation for _, _, run in found])
        return [Member(*one, key) for one, key in zip(found, keys, strict=True)]


Said = str | Path | Mapping[str, Any]
"""A study file, or what such a file says."""


def load_study(said: Said, name: str | None = None) -> Study:
    """Read a study file, or what such a file says, and check every run in it.

    Raises
    ------
    ValueError
        One line an error, each naming the file, the field, the value and what is allowed.
    """
    study = read_study(said, name)
    for experiment, model in study.model.experiments.items():
        try:
            _check_runs(experiment, model, study.runs[experiment])
            _check_beside(experiment, model, list(study.model.experiments))
        except ValueError as error:
            raise ValueError(f"{_source(said)}: {error}") from None
    return study


def read_study(said: Said, name: str | None = None) -> Study:
    """Read a study that was checked before, so that its runs need no check."""
    if isinstance(said, Mapping):
        model, folder, own = study_model(said), Path(), name or "study"
    else:
        model, folder, own = read_study_file(said), Path(said).parent, Path(said).stem
    runs: dict[str, dict[str, Run]] = {}
    for experiment, section in model.experiments.items():
        try:
            runs[experiment] = _by_path(_expand(experiment, section, folder))
        except (ValueError, OSError) as error:
            where = f"{_source(said)}: experiments.{experiment}"
            raise ValueError(f"{where}: {cut(str(error))}") from None
    return Study(own, model, runs)


def _source(said: Said) -> str:
    """Where a study comes from, for messages."""
    return "study" if isinstance(said, Mapping) else str(said)


def _check_runs(name: str, experiment: Experiment, runs: dict[str, Run]) -> None:
    for run in runs.values():
        try:
            check_run(run)
            check_run_path(run.path)
        except (ValueError, OSError) as error:
            raise ValueError(f"experiments.{name}, run {run.path}: {cut(str(error))}") from None
    if isinstance(experiment, BenchmarkExperiment):
        _check_baseline(name, experiment.timing, list(runs.values()))


def _check_beside(name: str, experiment: Experiment, known: list[str]) -> None:
    """Raise ValueError where a table or a figure shows an experiment that there is none of."""
    for part, beside in (("figure", experiment.beside_figure), ("table", experiment.beside_table)):
        for other in beside:
            if other == name:
                raise ValueError(
                    f"experiments.{name}.{part}.beside: {other!r} is the experiment itself; leave it out"
                )
            if other not in known:
                unknown = unknown_name("experiment", other, known)
                raise ValueError(f"experiments.{name}.{part}.beside: {unknown}")


def _check_baseline(name: str, timing: TimingModel, runs: list[Run]) -> None:
    """Raise ValueError unless the baseline of a benchmark's speedups is one of its runs."""
    baseline = timing.baseline
    if baseline is not None and (count := sum(run.has(baseline) for run in runs)) != 1:
        raise ValueError(
            f"experiments.{name}.timing.baseline: {baseline} are the values of {count} runs, must be of one"
        )


def _by_path(runs: Iterable[Run]) -> dict[str, Run]:
    """Runs by their paths; ValueError where two values have one name."""
    found: dict[str, Run] = {}
    for run in runs:
        other = found.setdefault(run.path, run)
        if other.values != run.values:
            raise ValueError(
                f"sweep: {dict(other.values)} and {dict(run.values)} both have the path {run.path}; take one"
            )
    return found


def _expand(name: str, experiment: Experiment, folder: Path) -> Iterator[Run]:
    """The runs of an experiment, each before those that it is measured against."""
    for block in experiment.sweep:
        keys = sorted(block, key=place)
        lists = [_values(key, block[key]) for key in keys]
        for values in itertools.product(*lists):
            run = Run(name, experiment, tuple(zip(keys, values, strict=True)), folder=folder)
            yield run
            yield from run.measured_against


def _values(key: str, entry: Any) -> list[Any]:
    """The values of one sweep entry; whole numbers of real parameters become real."""
    real = parameter(coordinate(key)).real
    return [float(v) if real and type(v) is int else v for v in values_of(entry)]
