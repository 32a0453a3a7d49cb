"""Notebooks, executed, with outputs that are small and say the same each time.

``python -m granstudy.analysis.notebook notebooks/1_cooling_curve.ipynb`` executes a notebook in a folder of
its own, and writes the outputs into it.
"""

import base64
import io
import os
import re
import sys
import tempfile
from contextlib import chdir
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from PIL import Image

from granstudy.support.files import write_whole

LONGEST_CELL_SECONDS = 600

COLOURS = 256
"""Colours that a picture in a notebook is kept in. Rare ones count as much: a thin line keeps its colour."""

DROPPED = r"0x[0-9a-f]{6,}"
"""Addresses in memory, which differ from run to run."""

BAR = r"\r*[^\r\n]*%\|[^\r\n]*\r*"
"""A bar of progress."""

WARNED = re.compile(r"^\S*ipykernel_\d+/\d+\.py:\d+: (.*?)\n  [^\n]*\n?", re.M | re.S)
"""A warning as Python writes it: place, text, and the line of code."""


def execute_notebook(source: str | Path, target: str | Path, results: str | None = None) -> None:
    """Execute ``source`` and write it, with its outputs, to ``target``.

    Parameters
    ----------
    results : str, optional
        Folder of a study's results. A notebook with a cell tagged ``parameters`` is executed in the current
        folder, after this cell was made to set it. Any other is executed in an empty folder of its own.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails; nothing is written then.
    """
    notebook = nbformat.read(source, as_version=4)
    named = [c for c in notebook.cells if "parameters" in c.metadata.get("tags", ())]
    for cell in named:
        cell.source = f"results = {results!r}"
    target = Path(target).resolve()
    with tempfile.TemporaryDirectory() as own, chdir(os.curdir if named else own):
        NotebookClient(notebook, timeout=LONGEST_CELL_SECONDS, kernel_name="python3").execute()
    clean(notebook)
    write_whole(target, lambda partial: nbformat.write(notebook, partial))


def clean(notebook: nbformat.NotebookNode) -> None:
    """Leave out of a notebook what differs between two executions: times, places, bars, large tables of HTML.

    Pictures are kept in few colours.
    """
    notebook.metadata.pop("widgets", None)
    notebook.metadata.language_info = {"name": "python"}
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type == "code":
            cell.outputs = [one for output in cell.outputs if (one := _cleaned(output)) is not None]


def _cleaned(output: nbformat.NotebookNode) -> nbformat.NotebookNode | None:
    """An output without what differs; None where nothing is left."""
    if output.output_type == "stream":
        output.text = without_places(output.text)
        return output if output.text.strip() else None
    data = output.get("data", {})
    if "image/png" in data:
        data["image/png"] = smaller(data["image/png"])
        data.pop("text/plain", None)  # "<Figure size ...>"
    if "xr-wrap" in data.get("text/html", ""):
        del data["text/html"]  # xarray's, with names drawn by lot; its text stays
    for kind, text in data.items():
        if kind.startswith("text/"):
            data[kind] = re.sub(DROPPED, "0x0", text)
    return output


def without_places(text: str) -> str:
    """A stream without bars of progress, and with warnings that do not say where they were raised."""
    shown = WARNED.sub(lambda found: f"{found[1]}\n", re.sub(BAR, "", text))
    return re.sub(DROPPED, "0x0", shown).lstrip("\n")


def smaller(picture: str) -> str:
    """A PNG in base64, in few colours and without metadata."""
    image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
    stream = io.BytesIO()
    few = image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(stream, "PNG", optimize=True)
    return base64.b64encode(stream.getvalue()).decode("ascii") + "\n"


if __name__ == "__main__":
    for name in sys.argv[1:]:
        execute_notebook(name, name)
