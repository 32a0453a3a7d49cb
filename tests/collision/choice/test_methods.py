"""The registry of methods: one row each, and the operator that each solver gets."""

import dataclasses

import pytest

import granstudy as gs
from granstudy.collision.choice.methods import OPERATORS, check, maker
from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.collision.fast.gpu.operator import adaptive_on_gpu, fast_on_gpu
from granstudy.collision.fast.operator import fast_operator
from granstudy.collision.radial.operator import RadialOperator
from granstudy.model.methods import METHODS


def test_every_method_with_an_operator_has_a_row():
    with_operator = {n for n, m in METHODS.items() if not (m.chooses or m.by_particles)}
    assert set(OPERATORS) == with_operator


def test_rows_have_what_their_methods_take():
    for name, row in OPERATORS.items():
        takes = METHODS[name].takes
        assert ("device" in takes) == (row.on_gpu is not None), name
        if "rtol" in takes and not METHODS[name].radial:  # which has no quadrature to choose
            assert row.tuned is not None, name


@pytest.mark.parametrize(
    ("settings", "made_by"),
    [
        ({}, fast_operator),
        ({"rtol": 1e-3}, AdaptiveOperator),
        ({"device": "gpu"}, fast_on_gpu),
        ({"device": "gpu", "rtol": 1e-3}, adaptive_on_gpu),
        ({"method": "radial"}, RadialOperator),
        ({"method": "radial", "rtol": 1e-3}, RadialOperator),
    ],
)
def test_who_makes_the_operator(settings, made_by):
    assert maker(gs.Solver(8, 5.0, **settings)) is made_by


def test_checks_come_before_any_work():
    scene = gs.load_scene("double_well2d", restitution=0.5)
    with pytest.raises(ValueError, match="isotropic"):
        OPERATORS["radial"].check(scene, gs.Solver(8, 5.0, method="radial").sized())
    with pytest.raises(ValueError, match="'carleman' takes"):
        hard = gs.load_scene("double_well2d", restitution=0.5, kernel=gs.hard_spheres(2))
        OPERATORS["carleman"].check(hard, gs.Solver(8, 5.0, method="carleman").sized())
    with pytest.raises(ValueError, match="M_sph"):
        bkw = gs.load_scene("bkw3d", restitution=0.5)
        OPERATORS["fast"].check(bkw, gs.Solver(8, 5.0, M_sph=17, sphere_rule="lebedev").sized())


@pytest.mark.parametrize("name", list(OPERATORS))
def test_the_check_of_a_method_knows_which_restitutions_it_takes(name):
    law = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1))
    solver = gs.Solver(8, 5.0, M_cir=8, method=name).sized()
    if METHODS[name].laws:
        check(law, solver)
        assert gs.collision_operator(law, solver).grid.dim == 2
    else:
        with pytest.raises(ValueError, match=f"method '{name}' takes a constant"):
            check(law, solver)


def test_the_check_of_a_method_knows_its_dimensions(monkeypatch):
    planar = dataclasses.replace(METHODS["literal"], dimensions=(2,))
    monkeypatch.setitem(METHODS, "literal", planar)
    solver = gs.Solver(8, 5.0, method="literal").sized()
    check(gs.load_scene("bkw2d"), solver)
    with pytest.raises(ValueError, match="dim=3: method 'literal' takes 2"):
        check(gs.load_scene("bkw3d"), solver)
