"""Figures of an experiment, drawn from its table and its runs."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.convergence import draw_convergence
from granstudy.analysis.figures.cooling import draw_cooling, draw_slope
from granstudy.analysis.figures.front import draw_front
from granstudy.analysis.figures.gallery import draw_gallery
from granstudy.analysis.figures.speed import draw_speed
from granstudy.analysis.figures.states import draw_states
from granstudy.analysis.figures.style import STYLE
from granstudy.analysis.source import FigureSource
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
from granstudy.support.errors import unknown_name
from granstudy.support.files import write_whole

Draw = Callable[[FigureSource], Figure]
"""Draws a figure of one kind; raises ValueError for a table that does not have what it shows."""

FIGURES: dict[str, Draw] = {
    "convergence": draw_convergence,
    "cooling": draw_cooling,
    "speed": draw_speed,
    "front": draw_front,
    "slope": draw_slope,
    "states": draw_states,
    "gallery": draw_gallery,
}
"""The kinds of figures that a study file can ask for, as ``figure: {kind: ...}``."""


def check_kind(kind: str) -> None:
    """Raise ValueError unless `FIGURES` has the kind."""
    if kind not in FIGURES:
        raise unknown_name("kind", kind, list(FIGURES))


def draw(
    experiment: Experiment,
    table: xr.Dataset,
    run_files: Sequence[str],
    beside: Sequence[xr.Dataset] = (),
    runs: Mapping[str, Run] | None = None,
) -> Figure:
    """Draw an experiment's figure, of the kind its study file asks for.

    Parameters
    ----------
    experiment : Experiment
    table : xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`.
    run_files : sequence of str
        The runs' files; ``cooling`` and ``slope`` figures need them.
    beside : sequence of xarray.Dataset
        Tables of other experiments, which ``front`` and ``states`` show in panels of their own.
    runs : dict of Run, optional
        The experiment's runs by path, in the order of their files; a ``gallery`` needs them.

    Raises
    ------
    ValueError
        If the experiment asks for no figure or one of an unknown kind, or the table does not have what the
        figure shows.
    """
    source = FigureSource(
        experiment=experiment, runs=runs or {}, files=run_files, beside=beside, table=table
    )
    check_kind(source.asked.kind)
    with mpl.rc_context(STYLE):
        figure = FIGURES[source.asked.kind](source)
        figure.suptitle(source.asked.title or experiment.title, fontsize=10)
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
