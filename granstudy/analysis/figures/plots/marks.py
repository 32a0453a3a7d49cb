"""Marks of trust: filled for trusted runs, hollow for marginal ones, hollow and pale for untrusted ones."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from granstudy.trust.flags import Trust

PALE = 0.4
"""Opacity of what is untrusted."""

MOST_MARKERS = 25
"""Markers of a line; of longer lines each so-many-th point has one."""

LOOKS: dict[int, dict[str, Any]] = {
    Trust.TRUSTED: {},
    Trust.MARGINAL: {"markerfacecolor": "white"},
    Trust.UNTRUSTED: {"markerfacecolor": "white", "alpha": PALE},
}
"""What a label does to a marker."""

WORDS = {Trust.MARGINAL: "marginal", Trust.UNTRUSTED: "untrusted"}
"""Names of marks in a legend."""


def mark(ax: Axes, x: np.ndarray, y: np.ndarray, trust: np.ndarray, look: dict[str, Any]) -> None:
    """Put markers on points, each as its label says.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
    trust : ndarray of int, shape (n,)
        `granstudy.trust.flags.Trust`; other numbers count as trusted, as they stand for no label.
    look : dict
        Colour and marker.
    """
    shown = np.arange(0, x.size, max(1, -(-x.size // MOST_MARKERS)))
    drawn = np.zeros(x.size, bool)
    drawn[shown] = True
    plain = {k: v for k, v in look.items() if k in ("color", "marker", "markersize", "zorder")}
    for label, change in LOOKS.items():
        its = trust == label
        if label == Trust.TRUSTED:
            its |= ~np.isin(trust, list(LOOKS))
        part = its & drawn & np.isfinite(y)
        if part.any():
            ax.plot(x[part], y[part], linestyle="none", **plain | change)


def line_opacity(trust: np.ndarray) -> float:
    """Opacity of a line: pale where all of it is untrusted."""
    return PALE if trust.size and bool((trust == Trust.UNTRUSTED).all()) else 1.0


def trust_handles(trusts: Iterable[np.ndarray], marker: str = "o") -> list[Line2D]:
    """Legend of the marks that a figure has; empty where all is trusted."""
    found = set[int]()
    for trust in trusts:
        found |= {int(label) for label in np.unique(trust)}
    return [
        Line2D(
            [],
            [],
            label=word,
            **{"color": "0.3", "linestyle": "none", "marker": marker} | LOOKS[label],
        )
        for label, word in WORDS.items()
        if int(label) in found
    ]
