"""Studies: from a study file to its checked runs."""

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granstudy.datasets.parameters import PARAMETERS, SWEPT
from granstudy.study.checks import check_run
from granstudy.study.run import Run
from granstudy.study.schema.experiment import BenchmarkExperiment, Experiment, TimingModel
from granstudy.study.schema.file import StudyFile, read_study_file
from granstudy.support.errors import unknown_name


@dataclass(frozen=True)
class Study:
    """A checked study file; ``runs`` by experiment, then by path, references among them."""

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


def load_study(path: str | Path) -> Study:
    """Read a study file and check every run in it.

    Raises
    ------
    ValueError
        One line an error, each naming the file, the field, the value and what is allowed.
    """
    model = read_study_file(path)
    runs: dict[str, dict[str, Run]] = {}
    for name, experiment in model.experiments.items():
        try:
            runs[name] = _checked_runs(name, experiment)
            _check_beside(name, experiment, list(model.experiments))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    return Study(Path(path).stem, model, runs)


def _checked_runs(name: str, experiment: Experiment) -> dict[str, Run]:
    """The runs of an experiment by path, references among them, each checked."""
    runs: dict[str, Run] = {}
    for run in _expand(name, experiment):
        try:
            check_run(run)
        except ValueError as error:
            raise ValueError(f"experiments.{name}, run {run.path}: {error}") from None
        runs[run.path] = run
    if isinstance(experiment, BenchmarkExperiment):
        _check_baseline(name, experiment.timing, list(runs.values()))
    return runs


def _check_beside(name: str, experiment: Experiment, known: list[str]) -> None:
    """Raise ValueError where a table or a figure shows an experiment that there is none of."""
    for part, beside in (("figure", experiment.beside_figure), ("table", experiment.beside_table)):
        for other in beside:
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


def _expand(name: str, experiment: Experiment) -> list[Run]:
    runs = []
    for block in experiment.sweep:
        keys = [key for key in SWEPT if key in block]
        lists = [_as_list(key, block[key]) for key in keys]
        for values in itertools.product(*lists):
            run = Run(name, experiment, tuple(zip(keys, values, strict=True)))
            runs.append(run)
            runs.extend(run.measured_against)
    return runs


def _as_list(key: str, value: Any) -> list[Any]:
    """The values of one sweep entry; whole numbers of real parameters become real."""
    values = value if isinstance(value, list) else [value]
    real = PARAMETERS[key].real
    return [float(v) if real and type(v) is int else v for v in values]
