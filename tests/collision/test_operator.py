"""What no operator can be made for, or called with: the message says why."""

import numpy as np
import pytest

import granstudy as gs

GOOD_SOLVER = {"N": 8, "R": 7.0}


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
