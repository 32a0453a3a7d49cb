"""Sources of tables and figures: an experiment, its runs, their files, tables of other experiments."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import xarray as xr

from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment, FigureModel


class Row(NamedTuple):
    """A run that is a row of a table, and its file."""

    run: Run
    file: str


@dataclass(frozen=True, kw_only=True)
class Source:
    """An experiment and the results that it has so far.

    Attributes
    ----------
    experiment : Experiment
    runs : dict of Run
        The experiment's runs by path, references and truths among them.
    files : sequence of str
        The runs' files in the same order; of a benchmark its one file.
    beside : sequence of xarray.Dataset
        Tables of other experiments, in the order in which the study file names them.
    """

    experiment: Experiment
    runs: Mapping[str, Run]
    files: Sequence[str]
    beside: Sequence[xr.Dataset] = ()

    @property
    def by_path(self) -> dict[str, str]:
        """File of every run by the run's path."""
        return dict(zip(self.runs, self.files, strict=True))

    @property
    def rows(self) -> list[Row]:
        """The runs that are rows of the table: references and truths are not."""
        pairs = zip(self.runs.values(), self.files, strict=True)
        return [Row(run, file) for run, file in pairs if not run.is_reference]


@dataclass(frozen=True, kw_only=True)
class TableSource(Source):
    """Source of a table.

    Attributes
    ----------
    quantity : str
        Column that the study file asks for, or the default of the kind of run.
    """

    quantity: str


@dataclass(frozen=True, kw_only=True)
class FigureSource(Source):
    """Source of a figure.

    Attributes
    ----------
    table : xarray.Dataset
        The experiment's table, from `granstudy.analysis.tables.table.experiment_table`.
    """

    table: xr.Dataset

    @property
    def asked(self) -> FigureModel:
        """The study file's request.

        Raises
        ------
        ValueError
            If the study file asks for no figure.
        """
        if self.experiment.figure is None:
            raise ValueError(f"{self.experiment.title}: asks for no figure")
        return self.experiment.figure

    @property
    def row_files(self) -> list[str]:
        """Files of the table's rows; all files where no runs are given."""
        return [row.file for row in self.rows] if self.runs else list(self.files)
