"""Padded products: nothing wraps around, so that `fast` is the truncated sum of `direct`."""

import numpy as np
import pytest
from comparison import asymmetric_scene, relative_error

import granstudy as gs
from granstudy.support.errors import ToleranceError

BOXES = {2: {"N": 16, "R": 7.0}, 3: {"N": 12, "R": 7.0}}
"""Coarse grids, on which aliasing is large."""

CONVERGED = {
    2: {"M_cir": 64, "N_rho": 24, "radial_rule": "jacobi"},
    3: {"M_sph": 302, "N_rho": 24, "radial_rule": "jacobi", "sphere_rule": "lebedev"},
}


def paired(f):
    """The function without its unpaired modes k_i = −N/2, which the methods treat in their own ways."""
    f_hat = np.fft.fftn(f)
    for axis in range(f.ndim):
        np.moveaxis(f_hat, axis, 0)[len(f) // 2] = 0.0
    return np.fft.ifftn(f_hat).real


@pytest.mark.parametrize("variant", ["separate", "full"])
@pytest.mark.parametrize(("dim", "floor"), [(2, 1e-13), (3, 3e-6)])
def test_padded_products_are_the_truncated_sum(dim, floor, variant):
    scene = asymmetric_scene(dim, seed=3, exponent=1.0, restitution=0.4)
    direct = gs.collision_operator(scene, gs.Solver(**BOXES[dim], method="direct", N_rho=None))
    f = paired(scene.density(direct.grid))
    exact = paired(direct(f))
    box = BOXES[dim] | CONVERGED[dim] | {"variant": variant}
    padded, plain = (
        gs.collision_operator(scene, gs.Solver(**box, dealias=dealias)) for dealias in (True, False)
    )
    assert relative_error(padded(f), exact) < floor
    assert relative_error(paired(plain(f)), exact) > 1e-4
    assert padded.transforms == plain.transforms + 2


def test_a_tolerance_is_met_where_aliasing_would_stop_it():
    scene = asymmetric_scene(2, seed=3, exponent=1.0, restitution=0.4)
    with pytest.raises(ToleranceError, match="or dealias=True"):
        gs.collision_operator(scene, gs.Solver(**BOXES[2], rtol=1e-6))
    operator = gs.collision_operator(scene, gs.Solver(**BOXES[2], rtol=1e-6, dealias=True))
    fine = gs.collision_operator(scene, gs.Solver(**BOXES[2] | CONVERGED[2], dealias=True))
    f = scene.density(operator.grid)
    assert relative_error(operator(f), fine(f)) < 1e-6
    assert operator.plan.n == 24 and operator.plan.aliasing < 1e-13
    assert operator.transforms == operator.plan.transforms == 2 * operator.plan.nodes + 5


def test_symmetry_and_mass_are_kept():
    scene = gs.load_scene("bkw3d", restitution=0.5)
    box = BOXES[3] | {"M_sph": 26, "sphere_rule": "lebedev", "variant": "full", "dealias": True}
    operator = gs.collision_operator(scene, gs.Solver(**box))
    f = scene.density(operator.grid)
    Q = operator(f)
    scene.symmetry.check(Q, "Q")
    assert abs(Q.sum()) < 1e-12 * np.abs(Q).sum()
