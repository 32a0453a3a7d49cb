"""Edits of the code that a run depends on change its fingerprint; other edits do not."""

import shutil

import pytest

from granstudy.study.run_key import run_fingerprint
from granstudy.support import fingerprint as module
from granstudy.support.fingerprint import fingerprint

METHODS = ["literal", "direct", "fast", "radial"]


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A copy of the package, for the fingerprints to read, and how to edit it."""
    copy = tmp_path / "granstudy"
    shutil.copytree(module.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__", "*.nb*"))
    monkeypatch.setattr(module, "PACKAGE", copy)
    monkeypatch.setattr(
        module, "DATA", {"granstudy.quadrature.design_data": copy / "quadrature" / "data"}
    )
    forget()
    yield copy
    forget()


def forget():
    module.imported_modules.cache_clear()
    module._tree.cache_clear()


def edited(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    forget()


def all_fingerprints():
    return {
        (kind, method): run_fingerprint(kind, method)
        for kind in ("evolution", "collision")
        for method in METHODS
    }


def changed(before):
    return {key for key, value in all_fingerprints().items() if value != before[key]}


def test_they_do_not_depend_on_where_the_package_lies(package):
    here = all_fingerprints()
    assert len(set(here.values())) == len(here)
    shutil.copytree(package, package.parent / "again" / "granstudy")
    module.PACKAGE = package.parent / "again" / "granstudy"
    forget()
    assert all_fingerprints() == here


def test_runs_on_the_cpu_do_not_depend_on_how_a_gpu_sums(package):
    before, gpu = all_fingerprints(), run_fingerprint("evolution", "fast on gpu")
    edited(package / "collision" / "fast" / "gpu" / "gain.py", "import ", "import cmath, ")
    assert changed(before) == set()
    assert run_fingerprint("evolution", "fast on gpu") != gpu


def test_comments_and_docstrings_change_nothing(package):
    before = all_fingerprints()
    for path in package.rglob("*.py"):
        path.write_text(path.read_text() + "\n# a comment\n\n'''Text below a constant.'''\n")
    edited(package / "evolution" / "evolve.py", '"""Advance a scene\'s', '"""Carry a scene\'s')
    edited(package / "trust" / "health.py", '"""A quantity, above', '"""Something, above')
    assert changed(before) == set()


@pytest.mark.parametrize(
    ("file", "old", "new", "kinds", "methods"),
    [
        ("velocity/moments.py", "2.0 * m.energy", "3.0 * m.energy", ["evolution"], METHODS),
        ("evolution/schemes.py", "dt / 6", "dt / 7", ["evolution"], METHODS),
        (
            "velocity/cartesian.py",
            "np.sqrt(2.0)",
            "np.sqrt(3.0)",
            ["evolution", "collision"],
            METHODS,
        ),
        ("velocity/radial.py", "import ", "import math, ", ["evolution", "collision"], ["radial"]),
        (
            "collision/fast/operator.py",
            "import ",
            "import math, ",
            ["evolution", "collision"],
            ["fast"],
        ),
        (
            "collision/literal.py",
            "import ",
            "import math, ",
            ["evolution", "collision"],
            ["literal"],
        ),
    ],
)
def test_an_edit_changes_the_runs_it_affects(package, file, old, new, kinds, methods):
    before = all_fingerprints()
    edited(package / file, old, new)
    found = changed(before)
    assert {(kind, method) for kind in kinds for method in methods} <= found
    assert {method for _, method in found} == set(methods)


def test_design_points_count_as_code(package):
    before = all_fingerprints()
    path = sorted((package / "quadrature" / "data").iterdir())[0]
    path.write_bytes(path.read_bytes() + b"\n")
    assert {("evolution", "fast"), ("collision", "literal")} <= changed(before)


def test_figures_and_tables_are_apart_from_runs_and_from_each_other(package):
    before = all_fingerprints()
    tables, figures = (
        fingerprint(["granstudy.analysis.tables.table"]),
        fingerprint(["granstudy.analysis.figures.figure"]),
    )
    edited(package / "analysis" / "figures" / "style.py", "WIDTH = 8.0", "WIDTH = 9.0")
    assert changed(before) == set()
    assert fingerprint(["granstudy.analysis.tables.table"]) == tables
    assert fingerprint(["granstudy.analysis.figures.figure"]) != figures
    edited(package / "collision" / "fast" / "operator.py", "import ", "import math, ")
    assert fingerprint(["granstudy.analysis.tables.table"]) == tables
    edited(package / "analysis" / "columns.py", "fitted order", "order")
    assert fingerprint(["granstudy.analysis.tables.table"]) != tables
    assert changed(before) == {("evolution", "fast"), ("collision", "fast")}


def test_runs_with_a_tolerance_depend_on_how_their_quadrature_is_chosen(package):
    before = all_fingerprints()
    adaptive = run_fingerprint("evolution", "adaptive")
    edited(
        package / "collision" / "fast" / "adaptive" / "search.py", "TARGET = 0.5", "TARGET = 0.4"
    )
    assert changed(before) == set()
    planned = run_fingerprint("evolution", "adaptive")
    assert planned != adaptive
    edited(package / "collision" / "fast" / "gain.py", "import ", "import math, ")
    assert run_fingerprint("evolution", "adaptive") != planned
    assert changed(before) == {("evolution", "fast"), ("collision", "fast")}
