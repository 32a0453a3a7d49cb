"""Edits of the code that a run depends on change its key; other edits do not."""

import pytest
from studies import code

from granstudy.model.load_scene import load_scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation
from granstudy.runs.run_key import run_key, run_keys
from granstudy.support.fingerprint import fingerprint

METHODS = ["literal", "direct", "fast", "radial"]
KINDS = ["evolution", "collision", "cooling state"]

STUDY = """
title: keys
experiments:
  fields:
    title: fields
    run: evolution
    scene: {name: bkw2d, restitution: 0.5}
    solver: {R: 7.0, N: 8}
    time: {t_final: 0.2, dt: 0.1}
    sweep:
      - {e: [0.2, 0.5], method: [fast, literal]}
"""


def computations(study):
    return [run.computation for run in study.runs["fields"].values()]


def all_fingerprints():
    return {(kind, method): code(kind, method) for kind in KINDS for method in METHODS}


def changed(before):
    return {key for key, value in all_fingerprints().items() if value != before[key]}


def test_keys_are_the_same_each_time_and_one_by_one(load):
    runs = computations(load())
    keys = run_keys(runs)
    assert keys == run_keys(runs) == [run_key(run) for run in runs]
    assert keys == run_keys(computations(load()))
    assert len(set(keys)) == len(runs)


def test_they_do_not_depend_on_where_the_package_lies(package):
    here = all_fingerprints()
    assert len(set(here.values())) == len(here)
    package.move(package.path.parent / "again")
    assert all_fingerprints() == here


def test_runs_on_the_cpu_do_not_depend_on_how_a_gpu_sums(package):
    before, gpu = all_fingerprints(), code("evolution", device="gpu")
    package.edit("collision/fast/gpu/gain.py", "import ", "import cmath, ")
    assert changed(before) == set()
    assert code("evolution", device="gpu") != gpu


def test_comments_and_docstrings_change_nothing(package):
    before = all_fingerprints()
    for path in package.path.rglob("*.py"):
        path.write_text(path.read_text() + "\n# a comment\n\n'''Text below a constant.'''\n")
    package.edit("evolution/evolve.py", '"""', '"""Other words. ')
    package.edit("trust/health.py", '"""', '"""Other words. ')
    assert changed(before) == set()


@pytest.mark.parametrize(
    ("file", "old", "new", "kinds", "methods"),
    [
        ("velocity/moments.py", "2.0 * m.energy", "3.0 * m.energy", ["evolution"], METHODS),
        ("evolution/schemes.py", "h / 6", "h / 7", ["evolution"], METHODS),
        ("velocity/cartesian.py", "np.sqrt(2.0)", "np.sqrt(3.0)", KINDS, METHODS),
        ("velocity/radial.py", "import ", "import math, ", KINDS[:2], ["radial"]),
        ("collision/fast/operator.py", "import ", "import math, ", KINDS, ["fast"]),
        ("collision/literal.py", "import ", "import math, ", KINDS, ["literal"]),
    ],
)
def test_an_edit_changes_the_runs_it_affects(package, file, old, new, kinds, methods):
    before = all_fingerprints()
    package.edit(file, old, new)
    found = changed(before)
    assert {(kind, method) for kind in kinds for method in methods} <= found
    # states look for the kind of grid themselves
    assert {method for kind, method in found if kind in kinds or kind != "cooling state"} == set(
        methods
    )


@pytest.mark.parametrize(
    ("file", "old", "new", "kind"),
    [
        ("runs/evaluate.py", '"Q is not finite"', '"Q is infinite"', "collision"),
        ("evolution/evolve.py", "import ", "import math, ", "evolution"),
        ("states/newton.py", "DENSE = 256", "DENSE = 200", "cooling state"),
    ],
)
def test_an_edit_of_what_computes_a_kind_changes_that_kind_alone(package, file, old, new, kind):
    before = all_fingerprints()
    package.edit(file, old, new)
    assert changed(before) == {(kind, method) for method in METHODS}


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        (
            "collision/choice/methods.py",
            "OPERATORS: dict[str, OperatorRow] = {",
            "OPERATORS: dict[str, OperatorRow] = {\n"
            '    "new": OperatorRow(LiteralOperator, check_rule, LITERAL),',
        ),
        (
            "model/methods.py",
            '    "literal": Method()',
            '    "new": Method(),\n    "literal": Method()',
        ),
        ("collision/operator.py", "import ", "import math, "),
        ("evolution/simulate.py", "import ", "import math, "),
        ("runs/kinds.py", "import ", "import math, "),
        ("runs/run_key.py", "import ", "import math, "),
    ],
)
def test_what_only_chooses_changes_nothing(package, file, old, new):
    before = all_fingerprints()
    open_ones = [code("evolution", "auto"), code("evolution", "auto", rtol=0.01, N=None, R=None)]
    particles = code("evolution", "dsmc", particles=1000)
    package.edit(file, old, new)
    assert changed(before) == set()
    assert open_ones == [
        code("evolution", "auto"),
        code("evolution", "auto", rtol=0.01, N=None, R=None),
    ]
    assert particles == code("evolution", "dsmc", particles=1000)


def test_runs_that_leave_something_open_depend_on_how_it_is_chosen(package):
    def codes():
        fields = {"N": None, "R": None, "rtol": 0.01}
        return [code("evolution", "auto"), code("evolution", "auto", **fields)]

    before, (method, size) = all_fingerprints(), codes()
    package.edit("collision/choice/grid.py", "EDGE = 1e-12", "EDGE = 1e-11")
    assert changed(before) == set()
    assert codes()[0] == method and codes()[1] != size
    package.edit("collision/choice/cheapest.py", "WORTH_IT = 1.2", "WORTH_IT = 1.3")
    assert changed(before) == set()
    assert codes()[0] != method


def test_particles_and_operators_do_not_depend_on_each_other(package):
    before, fast = code("evolution", "dsmc", particles=1000), code("evolution", "fast")
    package.edit("particles/collisions.py", "0.5 * (n - 1)", "0.6 * (n - 1)")
    edited = code("evolution", "dsmc", particles=1000)
    assert edited != before and code("evolution", "fast") == fast
    package.edit("collision/fast/operator.py", "import ", "import math, ")
    assert code("evolution", "dsmc", particles=1000) == edited


def test_design_points_count_as_code(package):
    before = all_fingerprints()
    path = sorted((package.path / "quadrature" / "data").iterdir())[0]
    path.write_bytes(path.read_bytes() + b"\n")
    package.forget()
    assert {("evolution", "fast"), ("collision", "literal")} <= changed(before)


def test_figures_and_tables_are_apart_from_runs_and_from_each_other(package):
    before = all_fingerprints()
    tables, figures = (
        fingerprint(["granstudy.analysis.tables.table"]),
        fingerprint(["granstudy.analysis.figures.figure"]),
    )
    package.edit("analysis/figures/style.py", "WIDTH = 8.0", "WIDTH = 9.0")
    assert changed(before) == set()
    assert fingerprint(["granstudy.analysis.tables.table"]) == tables
    assert fingerprint(["granstudy.analysis.figures.figure"]) != figures
    package.edit("collision/fast/operator.py", "import ", "import math, ")
    assert fingerprint(["granstudy.analysis.tables.table"]) == tables
    package.edit("analysis/columns.py", "fitted order", "order")
    assert fingerprint(["granstudy.analysis.tables.table"]) != tables
    assert changed(before) == {(kind, "fast") for kind in KINDS}


def test_runs_with_a_tolerance_depend_on_how_their_quadrature_is_chosen(package):
    before, adaptive = all_fingerprints(), code("evolution", rtol=0.01)
    package.edit("collision/fast/adaptive/search.py", "TARGET = 0.5", "TARGET = 0.4")
    assert changed(before) == set()
    planned = code("evolution", rtol=0.01)
    assert planned != adaptive
    package.edit("collision/fast/gain.py", "import ", "import math, ")
    assert code("evolution", rtol=0.01) != planned
    assert changed(before) == {(kind, "fast") for kind in KINDS}


@pytest.mark.fault("A5")
def test_a_run_follows_the_content_of_a_file_of_directions(tmp_path):
    path = tmp_path / "nodes.txt"
    keys = []
    for text in ("1 0 0\n", "0 1 0\n", "1 0 0\n"):
        path.write_text(text)
        solver = Solver(N=8, R=7.0, M_sph=1, sphere_rule=str(path))
        keys.append(Computation("collision", load_scene("bkw3d"), solver).parameters)
    assert keys[0] == keys[2] != keys[1]
