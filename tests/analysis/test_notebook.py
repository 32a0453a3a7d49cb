"""Notebooks: all are executed; committed outputs are small, clean, and of the code that stands there."""

import base64
import io
import re
from pathlib import Path

import nbformat
import pytest
from PIL import Image

from granstudy.analysis.notebook import clean, execute_notebook, smaller, without_places

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("[0-9]_*.ipynb"))
LONG = {"3_own_gas", "5_dask"}
"""Notebooks that take ten seconds or more."""

LARGEST_PICTURE = 60_000


def named(path):
    return pytest.param(path, id=path.stem, marks=pytest.mark.slow if path.stem in LONG else ())


def outputs(notebook):
    return [[dict(output) for output in cell.get("outputs", ())] for cell in notebook.cells]


def kinds(notebook):
    """What each cell shows, without the numbers."""
    return [
        [(one["output_type"], one.get("name"), tuple(one.get("data", ()))) for one in cell]
        for cell in outputs(notebook)
    ]


@pytest.mark.parametrize("path", [named(path) for path in NOTEBOOKS])
def test_a_notebook_is_executed_and_shows_what_is_committed(path, tmp_path):
    execute_notebook(path, tmp_path / "executed.ipynb")
    new, committed = (nbformat.read(one, 4) for one in (tmp_path / "executed.ipynb", path))
    assert kinds(new) == kinds(committed)
    printed, before = (
        [one["text"] for cell in outputs(book) for one in cell if one["output_type"] == "stream"]
        for book in (new, committed)
    )
    assert [re.sub(r"-?\d[\d.e+-]*", "#", text) for text in printed] == [
        re.sub(r"-?\d[\d.e+-]*", "#", text) for text in before
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_committed_outputs_are_small_and_say_no_time_and_no_place(path):
    text = path.read_text(encoding="utf-8")
    notebook = nbformat.reads(text, 4)
    shown = [one for cell in outputs(notebook) for one in cell]
    pictures = [one["data"]["image/png"] for one in shown if "image/png" in one.get("data", ())]
    assert pictures
    for picture in map(base64.b64decode, pictures):
        assert len(picture) <= LARGEST_PICTURE
        assert Image.open(io.BytesIO(picture)).info.keys() <= {"transparency"}
    seen = [str(one.get("text", one.get("data", {}).get("text/plain", ""))) for one in shown]
    assert not re.search(r"/tmp|/home|/work|ipykernel|it/s|%\||0x[1-9a-f]", "\n".join(seen))
    assert '"execution":' not in text
    assert "error" not in {one["output_type"] for one in shown}
    counts = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert counts == list(range(1, len(counts) + 1))


def made(source):
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    notebook.cells[0]["id"] = "cell"
    return notebook


def test_two_executions_give_the_same_bytes(tmp_path):
    source = (
        "import sys, time, warnings, xarray as xr\n"
        "from granstudy.analysis.figures.style import Picture\n"
        "print(object(), time.sleep(0.01))\n"
        "print('\\r 50%|###   | 1/2 [00:01<00:01]\\r100%|#####| 2/2', file=sys.stderr)\n"
        "warnings.warn('take care')\n"
        "xr.Dataset({'a': 1})\n"
    )
    nbformat.write(made(source), tmp_path / "a.ipynb")
    for name in "bc":
        execute_notebook(tmp_path / "a.ipynb", tmp_path / f"{name}.ipynb")
    assert (tmp_path / "b.ipynb").read_bytes() == (tmp_path / "c.ipynb").read_bytes()
    (shown,) = outputs(nbformat.read(tmp_path / "b.ipynb", 4))
    texts = [one.get("text", "") for one in shown]
    assert texts[:2] == ["<object object at 0x0> None\n", "UserWarning: take care\n"]
    assert list(shown[2]["data"]) == ["text/plain"]


def test_a_notebook_that_fails_leaves_its_target_alone(tmp_path):
    nbformat.write(made("1 / 0"), tmp_path / "a.ipynb")
    before = (tmp_path / "a.ipynb").read_bytes()
    with pytest.raises(Exception, match="ZeroDivisionError"):
        execute_notebook(tmp_path / "a.ipynb", tmp_path / "a.ipynb")
    assert (tmp_path / "a.ipynb").read_bytes() == before


def test_bars_go_and_other_texts_stay():
    assert without_places("\r  0%|   | 0/3\r100%|###| 3/3 [00:00]\n") == ""
    assert without_places("50% of it\nso it is\n") == "50% of it\nso it is\n"
    warned = "/a/ipykernel_1/2.py:3: UserWarning: one\ntwo\n  f(x)\nrest\n"
    assert without_places(warned) == "UserWarning: one\ntwo\nrest\n"


def test_a_picture_keeps_the_colours_of_thin_lines():
    image = Image.new("RGB", (400, 300), "white")
    for row, colour in enumerate([(0, 114, 178), (213, 94, 0), (0, 158, 115)]):
        image.putpixel((row, row), colour)
    stream = io.BytesIO()
    image.save(stream, "PNG")
    small = smaller(base64.b64encode(stream.getvalue()).decode())
    colours = {
        c for _, c in Image.open(io.BytesIO(base64.b64decode(small))).convert("RGB").getcolors()
    }
    assert {(0, 114, 178), (213, 94, 0), (0, 158, 115)} <= colours


def test_what_is_clean_stays_as_it_is():
    notebook = nbformat.read(NOTEBOOKS[0], 4)
    before = nbformat.writes(notebook)
    clean(notebook)
    texts = [
        [one for one in cell if "data" not in one] for cell in outputs(nbformat.reads(before, 4))
    ]
    assert [[one for one in cell if "data" not in one] for cell in outputs(notebook)] == texts
