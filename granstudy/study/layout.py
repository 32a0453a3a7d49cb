"""Where the results of a study lie, and what each of them is made from."""

from dataclasses import dataclass
from functools import cached_property

from granstudy.study.benchmark.benchmark import benchmark
from granstudy.study.estimates import chosen
from granstudy.study.jobs import Job, jobs
from granstudy.study.kinds import KINDS
from granstudy.study.run import Run
from granstudy.study.run_key import run_fingerprint
from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.file import MAP
from granstudy.study.study import Study
from granstudy.support.fingerprint import fingerprint

NOTEBOOKS: dict[str, dict[str, tuple[str, ...]]] = {
    "paper": {"cooling_and_convergence": ("table1", "figure4")}
}
"""Notebooks that are executed on a study's results, with the experiments whose runs they open, by study."""


@dataclass(frozen=True)
class Layout:
    """Files of a study's results.

    Attributes
    ----------
    study : Study
    folder : str
        Where the results of all studies lie.
    """

    study: Study
    folder: str = "results"

    @property
    def results(self) -> str:
        """Folder of the study's results."""
        return f"{self.folder}/{self.study.name}"

    @property
    def runs(self) -> str:
        """Folder of the datasets of its runs."""
        return f"{self.results}/runs"

    def experiment(self, name: str) -> Experiment:
        """What the study file says of an experiment."""
        return self.study.model.experiments[name]

    @cached_property
    def jobs(self) -> list[Job]:
        """The jobs of all experiments whose runs are computed one by one."""
        return [
            job
            for name, runs in self.study.runs.items()
            if not self._is_timed(name)
            for job in jobs(list(runs.values()))
        ]

    def _is_timed(self, name: str) -> bool:
        """Whether the experiment's runs are computed together, into one file."""
        return KINDS[self.experiment(name).run].compute is None

    def run_file(self, name: str, path: str) -> str:
        """Dataset of one run of an experiment."""
        return f"{self.runs}/{name}/{path}.nc"

    def unfinished(self, name: str) -> str:
        """Folder of what an experiment's jobs have computed so far.

        Each experiment has its own: two may share a run (a reference), and two jobs at once its key.
        """
        return f"{self.runs}/.unfinished/{name}"

    def run_files(self, name: str) -> list[str]:
        """Datasets of an experiment's runs; of a benchmark its one file."""
        if self._is_timed(name):
            return [f"{self.results}/benchmarks/{name}.nc"]
        return [self.run_file(name, path) for path in self.study.runs[name]]

    def table_file(self, name: str, form: str = "nc") -> str:
        """Table of an experiment, or of the map."""
        return f"{self.results}/tables/{name}.{form}"

    def figure_file(self, name: str, form: str = "png") -> str:
        """Figure of an experiment, or of the map."""
        return f"{self.results}/figures/{name}.{form}"

    def beside_table(self, name: str) -> list[str]:
        """Tables of the other experiments whose numbers stand in an experiment's table."""
        return [self.table_file(other) for other in self.experiment(name).beside_table]

    def beside_figure(self, name: str) -> list[str]:
        """Tables of the other experiments that an experiment's figure shows."""
        return [self.table_file(other) for other in self.experiment(name).beside_figure]

    def table_request(self, name: str) -> str:
        """What the study file says of an experiment that its table depends on, as JSON."""
        asked = {"title", "state", "table", "fit", "reference", "truth"}
        return self.experiment(name).model_dump_json(include=asked)

    def figure_request(self, name: str) -> str:
        """What the study file says of an experiment's figure, as JSON."""
        return self.experiment(name).model_dump_json(include={"title", "figure"})

    def benchmark_parameters(self, name: str) -> list[str]:
        """All that a benchmark's numbers depend on but the code."""
        runs = self._benchmarked(name)
        parameters = list(dict.fromkeys(run.parameters() for run in runs))
        return [*parameters, runs[0].timing.model_dump_json()]

    def benchmark_code(self, name: str) -> list[str]:
        """Fingerprints of the code that is timed, and of the code that times it."""
        kind = self.experiment(name).run
        timed = {run_fingerprint(kind, chosen(run)) for run in self._benchmarked(name)}
        return [*sorted(timed), fingerprint([benchmark.__module__])]

    def _benchmarked(self, name: str) -> list[Run]:
        """Runs of a benchmark, and those that their errors are measured against."""
        runs = list(self.study.runs[name].values())
        return runs + [run.reference for run in runs if run.has_reference]

    @property
    def tables(self) -> list[str]:
        """All tables that the study asks for, in three formats."""
        experiments = self.study.model.experiments
        asked = [name for name, experiment in experiments.items() if experiment.table is not None]
        return [self.table_file(name, form) for name in asked for form in ("nc", "csv", "md")]

    @property
    def figures(self) -> list[str]:
        """All figures that the study asks for, in two formats."""
        experiments = self.study.model.experiments
        asked = [name for name, experiment in experiments.items() if experiment.figure is not None]
        return [self.figure_file(name, form) for name in asked for form in ("png", "svg")]

    @property
    def map(self) -> list[str]:
        """The map of the study's cases, where the study asks for one."""
        asked = self.study.model.map is not None
        return [self.table_file(MAP), self.figure_file(MAP)] if asked else []

    @property
    def map_tables(self) -> list[str]:
        """Tables that the map is made from."""
        return [self.table_file(name) for name in self.study.model.with_truth]

    @property
    def notebooks(self) -> list[str]:
        """The executed notebooks of the study."""
        return [f"{self.results}/notebooks/{name}.ipynb" for name in self._notebooks]

    @property
    def _notebooks(self) -> dict[str, tuple[str, ...]]:
        return NOTEBOOKS.get(self.study.name, {})

    def notebook_files(self, name: str) -> list[str]:
        """Datasets that a notebook opens."""
        opened = self._notebooks.get(name, ())
        return [file for experiment in opened for file in self.run_files(experiment)]

    @property
    def wanted(self) -> list[str]:
        """All that the study asks for."""
        return [*self.tables, *self.figures, *self.map, *self.notebooks]
