"""Write the page of notebooks and its pictures: ``python docs/write_notebooks.py`` writes `notebooks.md`.

Titles, first sentences and pictures are those of the notebooks. A test says when the page is due.
"""

import base64
import json
from pathlib import Path
from typing import Any

from granstudy.support.files import write_text, write_whole

HERE = Path(__file__).parent

PAGE = HERE / "notebooks.md"

PICTURES = HERE / "_static" / "notebooks"
"""Where the pictures lie."""

NOTEBOOKS = sorted((HERE.parent / "notebooks").glob("[0-9]_*.ipynb"))
"""Notebooks that need no results of a study, in reading order."""

SHOWN = {"2_study": 1, "5_dask": 1}
"""Which of a notebook's pictures is shown; else the first."""

HEAD = """# Notebooks

Five notebooks, each executed in seconds. They need `pip install granstudy[notebook]`, and lie with their
outputs in `notebooks/` of the repository. This page is written by `python docs/write_notebooks.py`.
"""

TAIL = """## Executing them

| to do | command, in a clone |
| --- | --- |
| execute all into `results/<study>/notebooks` | `snakemake notebooks --cores 1` |
| refresh the outputs of one, in place | `python -m granstudy.analysis.notebook notebooks/4_trust.ipynb` |
| the notebook of the paper's study, after its runs | `snakemake --cores 2` |

Outputs are kept small and without times, places and bars: a refreshed notebook differs where its results do.
"""


def page() -> str:
    """The whole page."""
    return "\n".join([HEAD, *map(_entry, NOTEBOOKS), TAIL])


def _entry(path: Path) -> str:
    title, _, text = "".join(_cells(path)[0]["source"]).partition("\n\n")
    heading = title.removeprefix("# ")
    picture = f"![{heading}]({(PICTURES / path.stem).relative_to(HERE)}.png)"
    link = f"[{path.name}](../notebooks/{path.name})"
    return f"## {heading}\n\n{text}\n\n{picture}\n\n{link}\n"


def picture(path: Path) -> bytes:
    """The picture of a notebook that the page shows, as PNG."""
    outputs = [output for cell in _cells(path) for output in cell.get("outputs", ())]
    found = [
        output["data"]["image/png"] for output in outputs if "image/png" in output.get("data", ())
    ]
    return base64.b64decode("".join(found[SHOWN.get(path.stem, 0)]))


def _cells(path: Path) -> list[dict[str, Any]]:
    cells: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return cells


if __name__ == "__main__":
    for notebook in NOTEBOOKS:
        content = picture(notebook)
        write_whole(
            PICTURES / f"{notebook.stem}.png",
            lambda partial, content=content: partial.write_bytes(content),
        )
    write_text(PAGE, page())
