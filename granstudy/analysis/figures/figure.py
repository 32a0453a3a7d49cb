"""Figures of an experiment, drawn from its table and its runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.convergence import check_convergence, draw_convergence
from granstudy.analysis.figures.cooling import check_cooling, check_slope, draw_cooling, draw_slope
from granstudy.analysis.figures.front import check_front, draw_front
from granstudy.analysis.figures.gallery import check_gallery, draw_gallery
from granstudy.analysis.figures.plots.kinds import (
    check_map,
    check_profile,
    check_quantity_over,
    draw_map_over,
    draw_marginal,
    draw_over_maxwellian,
    draw_quantity_over,
    draw_tail,
)
from granstudy.analysis.figures.speed import check_speed, draw_speed
from granstudy.analysis.figures.states import check_states, draw_states
from granstudy.analysis.figures.style import STYLE
from granstudy.analysis.source import FigureSource
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
from granstudy.support.errors import unknown_name
from granstudy.support.files import write_whole


def _nothing(source: FigureSource) -> None:
    """Check nothing."""


@dataclass(frozen=True)
class Drawer:
    """How figures of one kind are drawn.

    Attributes
    ----------
    draw : callable
        Source ↦ the figure.
    shows : str
        What is seen, in words; ``{quantity}``, ``{x}`` and ``{y}`` stand for their long names.
    check : callable
        Source ↦ None; ValueError where the table does not have what the figure shows. It is called before any
        run, too: without files, with tables whose numbers are all 1.
    takes : tuple of str
        Fields of the study file's request that the kind takes, beside kind and title.
    """

    draw: Callable[[FigureSource], Figure]
    shows: str
    check: Callable[[FigureSource], None] = _nothing
    takes: tuple[str, ...] = ()


FIGURES: dict[str, Drawer] = {
    "convergence": Drawer(
        draw_convergence, "{quantity} against {x}, logarithmic", check_convergence, takes=("x",)
    ),
    "cooling": Drawer(draw_cooling, "temperature over time, with Haff's law fitted", check_cooling),
    "speed": Drawer(
        draw_speed, "seconds for one evaluation of Q against {x}", check_speed, takes=("x",)
    ),
    "front": Drawer(
        draw_front,
        "seconds against errors, of evaluations of Q or of whole runs",
        check_front,
        takes=("beside",),
    ),
    "slope": Drawer(
        draw_slope, "distance of d ln T/d ln t from Haff's −2/λ over time", check_slope
    ),
    "states": Drawer(
        draw_states,
        "a2 of states against the restitution coefficient, beside theories",
        check_states,
        takes=("beside",),
    ),
    "gallery": Drawer(
        draw_gallery,
        "temperature and a2 over time, and the density at the end, of every run beside its truth",
        check_gallery,
    ),
    "quantity": Drawer(
        draw_quantity_over, "{quantity} over {x}", check_quantity_over, takes=("x", "quantity")
    ),
    "map": Drawer(
        draw_map_over, "{quantity} over {x} and {y}", check_map, takes=("x", "y", "quantity")
    ),
    "over_maxwellian": Drawer(
        draw_over_maxwellian,
        "density over the Maxwellian of the same mass, velocity and temperature",
        check_profile,
    ),
    "tail": Drawer(draw_tail, "density at large velocities, in thermal speeds", check_profile),
    "marginal": Drawer(draw_marginal, "density of one component of the velocity", check_profile),
}
"""The kinds of figures that a study file can ask for, as ``figure: {kind: ...}``."""


def check_figure(source: FigureSource) -> None:
    """Raise ValueError unless the figure that an experiment asks for can be drawn from its table."""
    asked = source.asked
    if asked.kind not in FIGURES:
        raise ValueError(f"figure.kind: {unknown_name('kind', asked.kind, list(FIGURES))}")
    drawer = FIGURES[asked.kind]
    for field in ("x", "y", "quantity", "beside"):
        value = getattr(asked, field)
        if value and field not in drawer.takes:
            able = ", ".join(name for name, each in FIGURES.items() if field in each.takes)
            raise ValueError(f"figure.{field}={value!r}: only {able} take it, not {asked.kind}")
    drawer.check(source)


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
    check_figure(source)
    with mpl.rc_context(STYLE):
        figure = FIGURES[source.asked.kind].draw(source)
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
