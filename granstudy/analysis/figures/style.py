"""Look of figures: colours, markers, labels, sizes."""

import io
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Any

from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe & Ito, "Color Universal Design" (2008): told apart by colour-blind readers."""

MARKERS = ("o", "s", "^", "D")

FAMILY_COLOURS = {
    "direct": "#0072B2",
    "literal": "#8CC9F0",
    "fast": "#D55E00",
    "fast, single": "#7A3300",
    "fast, rtol": "#CC79A7",
    "fast, rtol, single": "#7B2E5A",
    "carleman": "#009E73",
    "radial": "#E69F00",
    "dsmc": "#999999",
    "fast, gpu": "#332288",
    "fast, single, gpu": "#6699CC",
    "fast, rtol, gpu": "#117733",
    "fast, rtol, single, gpu": "#999933",
}
"""Colours of `granstudy.analysis.labels.families`, the same in every figure, in the order of a legend."""


@dataclass(frozen=True)
class FamilyStyle:
    """Look of a family of runs, and its place in a legend."""

    colour: str
    marker: str
    place: int


def family_styles(names: Iterable[str]) -> dict[str, FamilyStyle]:
    """Looks of a figure's families, in the order of its legend.

    Families without a row in `FAMILY_COLOURS` come last, by name, in colours that the figure's others leave.
    """
    shown = set(names)
    listed = {name: place for place, name in enumerate(FAMILY_COLOURS)}
    others = sorted(shown - listed.keys())
    free = [c for c in COLOURS if c not in {FAMILY_COLOURS.get(name) for name in shown}]
    colours = FAMILY_COLOURS | dict(zip(others, cycle(free or COLOURS), strict=False))
    places = listed | {name: len(listed) + i for i, name in enumerate(others)}
    return {
        name: FamilyStyle(colours[name], MARKERS[places[name] % len(MARKERS)], places[name])
        for name in sorted(shown, key=places.__getitem__)
    }


class Picture(Figure):
    """A figure that notebooks show without pyplot."""

    def _repr_png_(self) -> bytes:
        target = io.BytesIO()
        self.savefig(target, format="png", dpi=100)
        return target.getvalue()


PAPER = "Hu & Ma (2019)"
PAPER_LOOK: dict[str, Any] = {
    "color": "black",
    "linestyle": "none",
    "marker": "o",
    "markerfacecolor": "none",
    "markersize": 11.0,
    "markeredgewidth": 0.9,
    "zorder": 4,
}
"""The paper's numbers, open and black around ours."""

LABELS = {
    "design": "spherical designs",
    "lebedev": "Lebedev",
    "product": "Gauss in cos θ × uniform φ",
    "gauss-theta-phi": "Gauss in θ × Gauss in φ",
}
"""Names in a legend of values that paths name shortly."""

STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "hatch.linewidth": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.4,
    "lines.markersize": 5.0,
    "svg.hashsalt": "granstudy",
}
"""Settings of Matplotlib."""

WIDTH = 8.0
PANEL_HEIGHT = 3.0
"""Width of a figure and height of a panel, in inches."""
