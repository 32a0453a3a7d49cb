"""Draw the rooms of granstudy and the imports between them: ``python docs/draw_rooms.py``.

Writes ``rooms.svg`` and ``rooms.png`` beside this file. Rooms, floors and imports are those of
`tests/architecture.py`; what a room is for is the first line of its ``__init__.py``.
"""

import re
import sys
import textwrap
from collections import Counter
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Polygon

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tests"))

from architecture import FLOORS, HOUSE, entries, floor, imports, purpose, room  # noqa: E402

ROOMS = [name for names in FLOORS for name in names]

ROW, GAP = 64.0, 10.0
"""Height of a room, and the space between rooms, in pixels."""

LEFT, FIRST_COLUMN, COLUMN = 40.0, 580.0, 34.0
"""Left side of the rooms, where the first arrow falls, and how far the next ones are."""

WIDTH = FIRST_COLUMN + COLUMN * len(ROOMS)
"""Width of the picture, which grows with the rooms: an arrow falls into each but the first."""

ROOF = 118.0
"""Height of the roof."""

TEXT, LETTER = 8.8, 6.3
"""Size of text in points, and about how wide a letter of that size is in pixels."""

HEADS = 78.0
"""Where the names of the arrows stand."""

INK, FAINT, BROKEN = "#22303c", "#8a99a6", "red"
"""Of what is drawn, of what leads the eye, and of imports that lead up."""

WALLS = LinearSegmentedColormap.from_list("floors", ["#fbe9cf", "#e9efe0", "#cfe0ea"])
STYLE = {"font.family": "DejaVu Sans", "svg.hashsalt": "granstudy", "text.color": INK}


def arrows() -> Counter[tuple[str, str]]:
    """How many pairs of files stand behind each import of one room from another."""
    pairs = sorted({(one.importer, one.imported) for one in imports(HOUSE)})
    both = Counter((room(importer), room(imported)) for importer, imported in pairs)
    return Counter({pair: count for pair, count in both.items() if pair[0] != pair[1]})


def contents(name: str) -> str:
    """What a room holds, folders first."""
    folder = HOUSE / name
    files = [entry.removesuffix(".py") for entry in entries(folder)]
    folders = [f"{entry}/" for entry in files if (folder / entry).is_dir()]
    return "  ".join([*folders, *(entry for entry in files if not (folder / entry).is_dir())])


def _top(name: str) -> float:
    """Upper side of a room; y points down."""
    return ROOF + GAP + ROOMS.index(name) * (ROW + GAP)


def _column(name: str) -> float:
    """Where the arrow into a room falls: to the right of all rooms above it."""
    return FIRST_COLUMN + COLUMN * (ROOMS.index(name) - 1)


def _right(name: str) -> float:
    return _column(name) + 0.6 * COLUMN


def _draw_room(axes: Axes, name: str) -> None:
    top, right = _top(name), _right(name)
    shade = WALLS(ROOMS.index(name) / (len(ROOMS) - 1))
    axes.add_patch(
        FancyBboxPatch(
            (LEFT, top),
            right - LEFT,
            ROW,
            boxstyle="round,pad=0,rounding_size=5",
            facecolor=shade,
            edgecolor=INK,
            linewidth=0.9,
            zorder=3,
        )
    )
    axes.text(
        LEFT + 12, top + 19, name, size=12, weight="bold", va="center_baseline", gid=f"room {name}"
    )
    what = re.sub(r"\s*\(.*?\)", "", purpose(HOUSE, name)).replace("`", "").rstrip(".")
    what = textwrap.shorten(what, int((right - LEFT - 135) / LETTER), placeholder=" …")
    axes.text(LEFT + 125, top + 19, what, size=TEXT, va="center_baseline", style="italic")
    inside = contents(name)
    size = min(TEXT, TEXT * (right - LEFT - 24) / (LETTER * len(inside)))
    axes.text(LEFT + 12, top + 44, inside, size=size, va="center", gid=f"in {name}")


def _draw_floors(axes: Axes) -> None:
    for names in FLOORS:
        top, bottom = _top(names[0]), _top(names[-1]) + ROW
        axes.plot([LEFT - 8] * 2, [top + 3, bottom - 3], color=FAINT, linewidth=1.2)
        number = str(floor(names[0]))
        axes.text(
            LEFT - 16, (top + bottom) / 2, number, size=8.5, color=FAINT, ha="right", va="center"
        )


def _draw_roof(axes: Axes) -> None:
    right = _right(ROOMS[0])
    corners = [(LEFT - 14, ROOF), ((LEFT + right) / 2, 12), (right + 14, ROOF)]
    axes.add_patch(Polygon(corners, facecolor="#f3d3c1", edgecolor=INK, linewidth=0.9, zorder=3))
    middle = (LEFT + right) / 2
    axes.text(middle, ROOF - 42, "granstudy", size=12, weight="bold", ha="center", va="center")
    says = "__init__.py: the public names"
    axes.text(middle, ROOF - 20, says, size=TEXT, style="italic", ha="center", va="center")


def _height(importer: str) -> float:
    """Where the line from a room to the arrows that it feeds runs."""
    return ROOF - 20 if importer == "granstudy" else _top(importer) + ROW / 2


def _draw_arrows(axes: Axes) -> None:
    counted = arrows()
    for importer in ("granstudy", *ROOMS):
        reached = [_column(imported) for (one, imported) in counted if one == importer]
        start = _right(ROOMS[0] if importer == "granstudy" else importer)
        if reached:
            y = _height(importer)
            axes.plot([start - 30, max(reached)], [y, y], color=FAINT, linewidth=0.8, zorder=1)
    for imported in ROOMS:
        heights = [_height(one) for (one, other) in counted if other == imported]
        if heights:
            x = _column(imported)
            axes.plot([x, x], [HEADS, min(heights)], color=FAINT, linewidth=0.8, zorder=1)
            axes.text(x - 3, HEADS - 3, imported, size=TEXT, rotation=50, rotation_mode="anchor")
            axes.annotate(
                "",
                (_column(imported), _top(imported)),
                (_column(imported), min(heights)),
                arrowprops={"arrowstyle": "-|>", "color": INK, "shrinkA": 0, "shrinkB": 0},
                zorder=2,
            )
    for (importer, imported), count in counted.items():
        at = (_column(imported), _height(importer))
        edge = INK if floor(importer) > floor(imported) else BROKEN
        axes.add_patch(Circle(at, 11, facecolor="white", edgecolor=edge, linewidth=0.9, zorder=4))
        gid = f"{importer} imports {imported}"
        axes.text(*at, str(count), size=8.2, ha="center", va="center_baseline", zorder=5, gid=gid)


def draw() -> Figure:
    """The picture."""
    height = _top(ROOMS[-1]) + ROW + 40
    figure = Figure((WIDTH / 100, height / 100), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, WIDTH), ylim=(height, 0))
    axes.set_axis_off()
    _draw_floors(axes)
    _draw_roof(axes)
    for name in ROOMS:
        _draw_room(axes, name)
    _draw_arrows(axes)
    says = "Numbers count imports from file to file: on the left stands who imports, below who is imported."
    axes.text(LEFT, height - 18, says, size=TEXT, va="center")
    return figure


def main() -> None:
    """Write both files."""
    with mpl.rc_context(STYLE):
        figure = draw()
        figure.savefig(HERE / "rooms.svg", metadata={"Date": None, "Creator": None})
        figure.savefig(HERE / "rooms.png", dpi=200, metadata={"Software": None})


if __name__ == "__main__":
    main()
