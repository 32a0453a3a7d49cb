"""What no operator can be made for, or called with: the message says why."""

import dataclasses
import tracemalloc

import numpy as np
import pytest

import granstudy as gs
from granstudy.collision.choice.cost import INTERPRETER_MB, estimate
from granstudy.collision.choice.method_costs import FAST
from granstudy.collision.choice.methods import OPERATORS

GOOD_SOLVER = {"N": 8, "R": 7.0}

AXES = "1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"


def solver_fields(solver):
    return {field.name: getattr(solver, field.name) for field in dataclasses.fields(gs.Solver)}


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"M_sph": 33}, "M_sph=33: rule 'design' has sizes 2, 6, 12"),
        ({"M_sph": 33, "sphere_rule": "lebedev"}, "M_sph=33"),
        ({"sphere_rule": "no/such/file.txt"}, "no/such/file.txt"),
    ],
)
def test_sphere_rules(settings, message):
    with pytest.raises(ValueError, match=message):
        gs.collision_operator(gs.load_scene("bkw3d"), gs.Solver(**GOOD_SOLVER, **settings))


def test_a_restitution_that_leaves_its_range_within_R():
    scene = gs.load_scene("bkw2d", restitution=lambda v: 1.0 - 0.5 * v)
    with pytest.raises(ValueError, match="impact speeds up to 7"):
        gs.collision_operator(scene, gs.Solver(**GOOD_SOLVER))


@pytest.mark.parametrize("method", ["literal", "direct", "fast"])
def test_densities(method):
    scene = gs.load_scene("bkw2d", restitution=0.5)
    operator = gs.collision_operator(scene, gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4, method=method))
    f = scene.density(operator.grid)
    with pytest.raises(ValueError, match=r"shape \(6, 6\): the grid's is \(8, 8\)"):
        operator(f[:6, :6])
    f[3, 3] = np.nan
    with pytest.raises(ValueError, match="NaN or infinite"):
        operator(f)


@pytest.mark.fault("C3")
@pytest.mark.parametrize(
    ("scene", "settings", "message"),
    [
        ("bkw2d", {"M_cir": 10**8}, "M_cir=100000000: at most 65536"),
        ("bkw3d", {"M_sph": (10**5, 10**5), "sphere_rule": "gauss-theta-phi"}, "M_sph=.*65536"),
        ("bkw3d", {"N_rho": 10**6}, "N_rho=1000000: at most 4096"),
        ("bkw3d", {"N": 4096}, "N=4096, N_rho=30, M_sph=32: takes about 2.2e.04 GB of memory"),
        ("bkw2d", {"N": 10**6}, "N=1000000, .*GB of memory, .*method 'fast'"),
        ("bkw3d", {"N": 10**5, "method": "radial"}, "N=100000: takes about .* method 'radial'"),
        ("bkw3d", {"N": 4096, "method": "auto"}, "N=2410: takes about .* method 'radial'"),
        ("bkw3d", {"N": 4096, "method": "literal"}, "method 'literal'"),
        ("bkw3d", {"N": 4096, "method": "direct", "N_rho": None}, "N=4096: takes about 550 GB"),
        ("bkw3d", {"N": 4096, "method": "carleman"}, "N=4096: takes about 550 GB"),
        ("bkw3d", {"N": 4096, "rtol": 1e-3}, "N=4096: takes about .* method 'fast'"),
    ],
)
def test_sizes_that_memory_cannot_hold_are_refused_before_any_allocation(scene, settings, message):
    scene = gs.load_scene(scene)
    solver = gs.Solver(**GOOD_SOLVER | settings)
    tracemalloc.start()
    with pytest.raises(ValueError, match=message):
        gs.collision_operator(scene, solver)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 10**8


@pytest.mark.parametrize("method", ["fast", "literal", "direct", "carleman"])
@pytest.mark.parametrize("scene", ["bkw2d", "bkw3d"])
def test_an_operator_takes_no_more_than_was_estimated(scene, method):
    scene = gs.load_scene(scene)
    solver = gs.Solver(N=32, R=7.0, threads=1, method=method).sized()
    allowed = estimate(OPERATORS[method].cost, scene, solver, 1).memory_mb - INTERPRETER_MB
    tracemalloc.start()
    operator = gs.collision_operator(scene, solver)
    kept, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert operator.grid.N == 32
    assert kept / 2**20 <= allowed


def test_a_rule_of_a_file_is_the_one_that_the_solver_was_made_with(tmp_path):
    path = tmp_path / "nodes.txt"
    path.write_text(AXES)
    solver = gs.Solver(**GOOD_SOLVER, N_rho=4, M_sph=6, sphere_rule=str(path), method="literal")
    scene = gs.load_scene("bkw3d")
    gs.collision_operator(scene, solver)
    path.write_text(AXES.replace("1 0 0", "0.6 0.8 0"))
    with pytest.raises(ValueError, match="the file has changed since the solver was made"):
        gs.collision_operator(scene, solver)
    gs.collision_operator(scene, gs.Solver(**solver_fields(solver)))


def test_estimates_follow_the_content_of_a_rules_file(tmp_path):
    path = tmp_path / "nodes.txt"
    scene, counts = gs.load_scene("bkw3d"), []
    for text in (AXES, AXES.replace("1 0 0", "0.6 0.8 0")):
        path.write_text(text)
        solver = gs.Solver(**GOOD_SOLVER, N_rho=4, M_sph=6, sphere_rule=str(path)).sized()
        counts.append(FAST.nodes(scene, solver))
    assert counts == [4, 24]
