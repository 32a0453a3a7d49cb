"""The registry of methods: one row each, and the operator that each solver gets."""

import pytest

import granstudy as gs
from granstudy.collision.choice.methods import OPERATORS, maker
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
