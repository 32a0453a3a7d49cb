"""Where the results of a study lie, and what each of them is made from."""

from dataclasses import dataclass
from pathlib import Path

from granstudy.runs.estimates import chosen
from granstudy.runs.run_key import run_fingerprint
from granstudy.runs.store import Store
from granstudy.study.benchmark.benchmark import benchmark
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.names import ATLAS, MAP
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
    def store(self) -> Store:
        """The store of runs, which all studies in the folder share."""
        return Store.beside(self.folder)

    @property
    def runs(self) -> str:
        """Folder of the study's runs: a name for each, of a file in the store."""
        return f"{self.results}/runs"

    @property
    def manifest(self) -> Path:
        """What the study's folder of runs holds, as JSON: experiment/path ↦ key."""
        return Path(self.runs) / "study.json"

    def experiment(self, name: str) -> Experiment:
        """What the study file says of an experiment."""
        return self.study.model.experiments[name]

    def run_file(self, name: str, path: str) -> str:
        """Dataset of one run of an experiment."""
        return f"{self.runs}/{name}/{path}.nc"

    def run_files(self, name: str) -> list[str]:
        """Datasets of an experiment's runs; of a benchmark its one file."""
        if self.study.is_timed(name):
            return [self.benchmark_file(name)]
        return [self.run_file(name, path) for path in self.study.runs[name]]

    def benchmark_file(self, name: str) -> str:
        """Dataset of all runs of a benchmark."""
        return f"{self.results}/benchmarks/{name}.nc"

    @property
    def jobs(self) -> Path:
        """Folder of the jobs: what each computes, how far it is, and the receipt of one that is done."""
        return Path(self.results) / "jobs"

    @property
    def overview(self) -> Path:
        """What was done and what was left when the workflow started, as JSON."""
        return self.jobs / "overview.json"

    @property
    def labels(self) -> Path:
        """Labels of the study's runs by key, as JSON; made anew where it is lost."""
        return self.jobs / "labels.json"

    def job_file(self, job: str) -> str:
        """What a job computes."""
        return f"{self.jobs}/{job}.json"

    def receipt(self, job: str) -> str:
        """Receipt of a job that has computed all its runs."""
        return f"{self.jobs}/{job}.done"

    def complete(self, name: str) -> str:
        """Keys of an experiment's runs, as JSON; the file is there while all of them are in the store."""
        return f"{self.results}/datasets/{name}.json"

    def awaited(self, name: str) -> str:
        """What the file `complete` will say, while some runs of an experiment are missing."""
        return f"{self.jobs}/{name}.runs"

    def since(self, name: str) -> str:
        """When runs of an experiment were first missing, since they were last all there; in nanoseconds.

        Snakemake takes a file that is gone for up to date where all that led to it is as it was. This is not.
        """
        return f"{self.jobs}/{name}.since"

    def dataset(self, name: str) -> str:
        """All runs of an experiment as one dataset, without densities; of a benchmark its one file."""
        return (
            self.benchmark_file(name)
            if self.study.is_timed(name)
            else f"{self.results}/datasets/{name}.nc"
        )

    def gathered(self, name: str) -> str:
        """What was gathered of an experiment in Python; a cache."""
        return f"{self.jobs}/{name}.gathered.nc"

    def table_file(self, name: str, form: str = "nc") -> str:
        """Table of an experiment, of the map, or of the atlas."""
        return f"{self.results}/tables/{name}.{form}"

    def figure_file(self, name: str, form: str = "png") -> str:
        """Figure of an experiment, of the map, or of the atlas."""
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
        parameters = list(dict.fromkeys(run.computation.parameters for run in runs))
        return [*parameters, runs[0].timing.model_dump_json()]

    def benchmark_code(self, name: str) -> list[str]:
        """Fingerprints of the code that is timed, and of the code that times it."""
        kind = self.experiment(name).computes
        choices = [chosen(run.computation) for run in self._benchmarked(name)]
        timed = {run_fingerprint(kind, choice) for choice in choices}
        return [*sorted(timed), fingerprint([benchmark.__module__])]

    def _benchmarked(self, name: str) -> list[Run]:
        """Runs of a benchmark, and those that their errors are measured against."""
        runs = list(self.study.runs[name].values())
        return runs + [run.reference for run in runs if run.has_reference]

    @property
    def datasets(self) -> list[str]:
        """The datasets of all experiments."""
        return [self.dataset(name) for name in self.study.model.experiments]

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
    def atlas(self) -> list[str]:
        """The atlas of the study's states, where the study asks for one."""
        asked = self.study.model.atlas is not None
        return [self.table_file(ATLAS), self.figure_file(ATLAS)] if asked else []

    @property
    def atlas_tables(self) -> list[str]:
        """Tables that the atlas is made from."""
        return [self.table_file(name) for name in self.study.model.with_states]

    @property
    def notebooks(self) -> list[str]:
        """The executed notebooks of the study."""
        return [f"{self.results}/notebooks/{name}.ipynb" for name in self._notebooks]

    @property
    def _notebooks(self) -> dict[str, tuple[str, ...]]:
        """Those whose runs the study has: another study may have the name, in a folder of its own."""
        known = self.study.model.experiments.keys()
        notebooks = NOTEBOOKS.get(self.study.name, {})
        return {name: opened for name, opened in notebooks.items() if known >= set(opened)}

    def notebook_files(self, name: str) -> list[str]:
        """Datasets that a notebook opens."""
        return [self.dataset(experiment) for experiment in self._notebooks.get(name, ())]

    @property
    def report(self) -> str:
        """The study on one page."""
        return f"{self.results}/index.html"

    def table_page(self, name: str) -> str:
        """Table of an experiment, of the map, or of the atlas, as a page for Snakemake's report."""
        return f"{self.results}/report/{name}.html"

    @property
    def tabled(self) -> list[str]:
        """Names that have a table: map, atlas, and experiments that ask for a table or a figure."""
        model = self.study.model
        names = [name for name, one in model.experiments.items() if one.table or one.figure]
        joint = {MAP: model.map, ATLAS: model.atlas}
        return [*(name for name, asked in joint.items() if asked is not None), *names]

    @property
    def reported(self) -> list[str]:
        """What the report shows."""
        return [*self.datasets, *self.tables, *self.figures, *self.map, *self.atlas]

    @property
    def wanted(self) -> list[str]:
        """All that the study asks for."""
        return [*self.reported, *self.notebooks, self.report]
