"""Looks of lines: a colour for each value of one parameter, a style for the others; their legend."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.figures.plots.scales import DECADES
from granstudy.analysis.figures.plots.series import Series, varying
from granstudy.analysis.figures.style import COLOURS, MARKERS

MOST_COLOURS = len(COLOURS)
"""Numbers up to which each value has a colour of its own; more have a colour bar."""

STYLES = ("-", "--", ":", "-.")

LETTERS = 76
"""Letters of a line of a legend below a figure."""


@dataclass(frozen=True)
class Bar:
    """A colour bar for many values of one number."""

    dim: str
    norm: Normalize
    colours: Colormap


@dataclass(frozen=True)
class Looks:
    """Looks of a plot's lines, by position.

    Attributes
    ----------
    lines : list of dict
        Colour, line style and marker of each line.
    handles : list of Line2D
        The legend.
    bar : Bar or None
    """

    lines: list[dict[str, Any]]
    handles: list[Line2D]
    bar: Bar | None = None


def colour_map() -> Colormap:
    """Colours of many values, which are told apart in grey too, without the palest."""
    return ListedColormap(mpl.colormaps["viridis"](np.linspace(0.0, 0.9, 256)))


def looks_of(series: Sequence[Series], label: Mapping[str, Any]) -> Looks:
    """Looks of lines.

    Parameters
    ----------
    series : sequence of Series
    label : mapping
        Dimension ↦ function of a value ↦ its text in a legend.
    """
    varied = varying(list(series))
    if not varied:
        return Looks([_look(COLOURS[0], 0) for _ in series], [])
    numeric = {d: len(v) for d, v in varied.items() if all(_is_number(x) for x in v)}
    colour_dim = max(
        numeric or {d: len(v) for d, v in varied.items()}, key=lambda d: len(varied[d])
    )
    others = [d for d in varied if d != colour_dim]
    combos = list(dict.fromkeys(tuple(one.key[d] for d in others) for one in series))
    values = varied[colour_dim]
    bar = _bar(colour_dim, values) if colour_dim in numeric and len(values) > MOST_COLOURS else None
    colours = [bar.colours(bar.norm(v)) for v in values] if bar else [
        COLOURS[i % len(COLOURS)] for i in range(len(values))
    ]  # fmt: skip
    lines = [
        _look(
            colours[values.index(one.key[colour_dim])],
            combos.index(tuple(one.key[d] for d in others)),
        )
        for one in series
    ]
    handles = []
    if bar is None:
        alone = not others
        handles += [
            Line2D([], [], label=label[colour_dim](v), **_look(c, 0) if alone else {"color": c})
            for v, c in zip(values, colours, strict=True)
        ]
    if others:
        handles += [
            Line2D(
                [],
                [],
                label=", ".join(label[d](v) for d, v in zip(others, combo, strict=True)),
                **_look("0.3", i),
            )
            for i, combo in enumerate(combos)
        ]
    return Looks(lines, handles, bar)


def add_legend(figure: Figure, handles: Sequence[Line2D]) -> None:
    """Put a legend below the figure's axes, where it covers no curve."""
    if not handles:
        return
    longest = max(len(_plain(str(handle.get_label()))) for handle in handles) + 6
    columns = max(1, min(len(handles), LETTERS // longest, 6))
    # Rows of about equal length look best.
    rows = -(-len(handles) // columns)
    figure.legend(handles=list(handles), loc="outside lower center", ncols=-(-len(handles) // rows))


def add_bar(figure: Figure, axes: Any, bar: Bar | None, title: str) -> None:
    """Put a colour bar beside the figure's axes."""
    if bar is not None:
        drawn = figure.colorbar(ScalarMappable(bar.norm, bar.colours), ax=axes, pad=0.02)
        drawn.set_label(title)


def _look(colour: Any, i: int) -> dict[str, Any]:
    return {
        "color": colour,
        "linestyle": STYLES[i % len(STYLES)],
        "marker": MARKERS[i % len(MARKERS)],
        "markersize": 4.5,
    }


def _bar(dim: str, values: Sequence[float]) -> Bar:
    numbers = np.array(values, dtype=float)
    low, high = float(numbers.min()), float(numbers.max())
    positive = numbers[numbers > 0.0]
    if low >= 0.0 and positive.size > 1 and high > DECADES * positive.min():
        # Where 0 is among them, as of times, it has the first colour.
        return Bar(dim, LogNorm(float(positive.min()), high, clip=True), colour_map())
    return Bar(dim, Normalize(low, high), colour_map())


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _plain(text: str) -> str:
    """About what a text of Matplotlib's mathematics looks like."""
    for word in ("\\mathrm", "\\varepsilon", "\\lambda", "$", "{", "}", "\\"):
        text = text.replace(word, "e" if word in ("\\varepsilon", "\\lambda") else "")
    return text
