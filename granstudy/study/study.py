"""Studies: from a study file to its checked runs."""

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granstudy.datasets.parameters import SWEPT
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
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
        runs[name] = {}
        for run in _expand(name, experiment):
            try:
                run.check()
            except ValueError as error:
                where = f"experiments.{name}, run {run.path}"
                raise ValueError(f"{path}: {where}: {error}") from None
            runs[name][run.path] = run
        try:
            _check_baseline(list(runs[name].values()))
        except ValueError as error:
            raise ValueError(f"{path}: experiments.{name}.{error}") from None
        for part in ("figure", "table"):
            asked = getattr(experiment, part)
            for other in asked.beside if asked else ():
                if other not in model.experiments:
                    known = list(model.experiments)
                    raise ValueError(
                        f"{path}: experiments.{name}.{part}.beside: "
                        f"{unknown_name('experiment', other, known)}"
                    )
    return Study(Path(path).stem, model, runs)


def _check_baseline(runs: list[Run]) -> None:
    """Raise ValueError unless the baseline of a benchmark's speedups is one of its runs."""
    baseline = runs[0].timing.baseline
    if baseline is not None and (count := sum(run.has(baseline) for run in runs)) != 1:
        raise ValueError(
            f"timing.baseline: {baseline} are the values of {count} runs, must be of one"
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
    real = key in ("e", "exponent", "epsilon", "R", "rtol", "time_rtol", "dt")
    return [float(v) if real and type(v) is int else v for v in values]
