"""Write the gallery of committed figures: ``python docs/write_gallery.py`` writes `gallery.md`.

The shipped studies say which experiments there are, in which order, and with which titles. A test says
when the page is due.
"""

from pathlib import Path

from granstudy.study.schema.names import ATLAS, MAP
from granstudy.study.study import read_study
from granstudy.support.files import write_text

HERE = Path(__file__).parent

PAGE = HERE / "gallery.md"

STUDIES = {
    "paper": "The paper's tables and figures.",
    "front": "Errors of T and a2 over the seconds of whole runs ([results](results.md)).",
    "pareto": "Speed against error of Q, of all methods.",
    "states": "Cooling and heated states, solved for directly, by theory and by particles.",
    "atlas": "Cooling and heated states over e and λ ([the atlas](states.md#4-the-atlas)).",
    "hard": "Gases that a fixed grid gets wrong, with labels ([hard cases](hard.md)).",
    "quick": "What CI computes anew and compares, in a minute.",
}
"""Studies with committed results, and what each is."""

HEAD = """# Gallery

Figures and tables that the shipped studies came to ([results](results.md)). Written by
`python docs/write_gallery.py`. `granstudy run studies/<study>.yaml` in a clone makes them anew,
into `results/`.
"""


def page() -> str:
    """The whole page."""
    return "\n".join([HEAD, *(_study(name, what) for name, what in STUDIES.items())])


def _study(name: str, what: str) -> str:
    """A study's figures with their titles, and its tables."""
    model = read_study(HERE.parent / "studies" / f"{name}.yaml").model
    titles = {key: one.title for key, one in model.experiments.items()}
    joint = {MAP: model.map, ATLAS: model.atlas}
    titles = {key: one.title for key, one in joint.items() if one is not None} | titles
    parts = [f"## {name}\n", f"{what}\n"]
    for key, title in titles.items():
        figure, table = (f"results/{name}/{place}" for place in _places(key))
        drawn, listed = ((HERE / path).is_file() for path in (figure, table))
        if drawn:
            parts.append(f"![{title}]({figure})\n")
        if drawn or listed:
            parts.append(f"*{title}*" + (f" ([table]({table}))\n" if listed else "\n"))
    return "\n".join(parts)


def _places(key: str) -> tuple[str, str]:
    return f"figures/{key}.png", f"tables/{key}.md"


if __name__ == "__main__":
    write_text(PAGE, page())
