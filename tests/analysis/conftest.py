"""Studies computed to their tables, and tables made by hand."""

import numpy as np
import pytest
import xarray as xr
from studies import computed, load_text

from granstudy.analysis.figures.figure import draw
from granstudy.analysis.tables.table import experiment_table


class Tabulated:
    """A study, the files of its runs and its tables, by experiment; others' tables come first."""

    def __init__(self, folder, text):
        self.folder, self.study = folder, load_text(folder, text)
        self.files, self.tables = {}, {}
        for name in self.study.runs:
            self._tabulate(name)

    def _tabulate(self, name):
        if name not in self.tables:
            for other in self.experiment(name).beside_table:
                self._tabulate(other)
            runs = self.study.runs[name]
            self.files[name] = computed(runs, self.folder / "runs" / name)
            self.tables[name] = self.table(name)

    def experiment(self, name):
        """What the study file says of an experiment."""
        return self.study.model.experiments[name]

    def table(self, name, experiment=None, beside=None):
        """An experiment's table, made anew: as another experiment asks for it, or beside other tables."""
        experiment = experiment or self.experiment(name)
        others = [self.tables[other] for other in experiment.beside_table]
        beside = others if beside is None else beside
        return experiment_table(experiment, self.study.runs[name], self.files[name], beside)

    def draw(self, name, experiment=None, table=None):
        """An experiment's figure."""
        experiment = experiment or self.experiment(name)
        table = self.tables[name] if table is None else table
        beside = [self.tables[other] for other in experiment.beside_figure]
        return draw(experiment, table, self.files[name], beside, self.study.runs[name])


@pytest.fixture(scope="module")
def made(request, tmp_path_factory):
    """The study of the test's module, computed."""
    return Tabulated(tmp_path_factory.mktemp("study"), request.module.STUDY)


@pytest.fixture
def tabulated(tmp_path):
    """A function that computes a study, given as its file's text."""
    return lambda text: Tabulated(tmp_path, text)


@pytest.fixture(scope="session")
def table_of():
    """A function that makes a table out of rows of swept values, ours and the paper's."""

    def table_of(rows, swept, quantity, **attributes):
        columns = list(zip(*rows, strict=True))
        coords = {name: ("run", list(values)) for name, values in zip(swept, columns, strict=False)}
        data = {quantity: ("run", np.array(columns[len(swept)]))}
        if len(columns) > len(swept) + 1:
            data["paper"] = ("run", np.array(columns[len(swept) + 1], dtype=float))
            attributes["paper_quantity"] = quantity
        attributes |= {"swept": " ".join(swept), "quantity": quantity, "title": "a title"}
        return xr.Dataset(data, coords, attributes)

    return table_of


@pytest.fixture
def front():
    """A front as `experiment_table` makes it; a tolerance that failed, and one thread beside two."""
    rows = [
        ("literal", -1.0, 2, 1e-2, 1.0, False, True),
        ("fast", -1.0, 2, 1e-2, 0.2, False, False),
        ("fast", 1e-2, 2, 5e-3, 0.05, True, False),
        ("fast", 1e-9, 2, np.nan, np.nan, False, False),
        ("fast", -1.0, 1, 1e-2, 0.4, True, False),
    ]
    method, rtol, threads, error, seconds, front, baseline = zip(*rows, strict=True)
    columns = {"error": error, "seconds": seconds, "front": front, "baseline": baseline}
    return xr.Dataset(
        {name: ("run", np.array(values)) for name, values in columns.items()},
        {
            "method": ("run", list(method)),
            "rtol": ("run", list(rtol)),
            "threads": ("run", list(threads)),
        },
        {"title": "a scene"},
    )
