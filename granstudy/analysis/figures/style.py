"""How figures look: colours, markers, labels, sizes."""

from typing import Any

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe & Ito, "Color Universal Design" (2008): told apart by colour-blind readers."""

METHOD_COLOURS = {
    "literal": "#8CC9F0",
    "fast": "#D55E00",
    "fast, single": "#7A3300",
    "fast, rtol": "#CC79A7",
    "fast, rtol, single": "#7B2E5A",
    "carleman": "#009E73",
    "direct": "#0072B2",
    "radial": "#E69F00",
    "dsmc": "#999999",
    "fast, gpu": "#332288",
    "fast, single, gpu": "#6699CC",
    "fast, rtol, gpu": "#117733",
    "fast, rtol, single, gpu": "#999933",
}
"""A method has the same colour in every figure."""

METHODS_FIRST = {
    name: place
    for place, name in enumerate(
        (
            "direct",
            "literal",
            "fast",
            "fast, single",
            "fast, rtol",
            "fast, rtol, single",
            "carleman",
            "radial",
            "dsmc",
            "fast, gpu",
            "fast, single, gpu",
            "fast, rtol, gpu",
            "fast, rtol, single, gpu",
        )
    )
}
"""From the slowest to the fastest, as a legend lists them."""

MARKERS = ("o", "s", "^", "D")
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


LABELS = {
    "design": "spherical designs",
    "lebedev": "Lebedev",
    "product": "Gauss in cos θ × uniform φ",
    "gauss-theta-phi": "Gauss in θ × Gauss in φ",
}
"""How the legend calls what a path names shortly."""

STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.4,
    "lines.markersize": 5.0,
    "svg.hashsalt": "granstudy",
}
WIDTH = 8.0
PANEL_HEIGHT = 3.0
