"""Figures of an experiment, drawn from its table and its runs."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.convergence import _convergence
from granstudy.analysis.figures.cooling import _cooling, draw_slope
from granstudy.analysis.figures.front import draw_front, draw_run_front
from granstudy.analysis.figures.gallery import draw_gallery
from granstudy.analysis.figures.speed import _speed
from granstudy.analysis.figures.states import draw_states
from granstudy.analysis.figures.style import STYLE
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
from granstudy.support.files import write_whole


def draw(
    experiment: Experiment,
    table: xr.Dataset,
    run_files: list[str],
    beside: Sequence[xr.Dataset] = (),
    runs: Mapping[str, Run] | None = None,
) -> Figure:
    """Draw an experiment's figure, of the kind its study file asks for.

    Parameters
    ----------
    experiment : Experiment
    table : xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`.
    run_files : list of str
        The runs' files; ``cooling`` and ``slope`` figures need them.
    beside : sequence of xarray.Dataset
        Tables of other experiments, which ``front`` and ``states`` show in panels of their own.
    runs : dict of Run
        The experiment's runs by path, in the order of their files; a ``gallery`` needs them.
    """
    asked = experiment.figure
    if asked is None:
        raise ValueError(f"{experiment.title}: asks for no figure")
    with mpl.rc_context(STYLE):
        if asked.kind == "cooling":
            figure = _cooling(table, run_files)
        elif asked.kind == "speed":
            figure = _speed(table)
        elif asked.kind == "front":
            of_runs = experiment.has_truth
            figure = draw_run_front(table) if of_runs else draw_front([table, *beside])
        elif asked.kind == "states":
            figure = draw_states([table, *beside])
        elif asked.kind == "slope":
            figure = draw_slope(table, run_files)
        elif asked.kind == "gallery":
            assert runs is not None
            files = dict(zip(runs, run_files, strict=True))
            rows = [(run, files[path]) for path, run in runs.items() if not run.is_reference]
            figure = draw_gallery(table, rows, files)
        else:
            figure = _convergence(table, asked.x)
        figure.suptitle(asked.title or experiment.title, fontsize=10)
    return figure


def save_figure(figure: Figure, png: str | Path, svg: str | Path) -> None:
    """Write a figure as PNG and SVG, each whole or not at all, same figure same bytes."""
    with mpl.rc_context(STYLE):
        for path, metadata in ((Path(png), {"Software": None}), (Path(svg), {"Date": None})):
            write_whole(
                path,
                lambda partial, metadata=metadata: figure.savefig(
                    partial, dpi=200, metadata=metadata
                ),
            )
