"""Grids chosen for a scene: the exact cooling rate to the tolerance that was asked for."""

import numpy as np
import pytest
from comparison import asymmetric_scene
from scipy.special import gammaincc

import granstudy as gs
from granstudy.collision.choice.grid import R_STEP, collision_radius


@pytest.mark.parametrize("name", ["bkw2d", "double_well2d", "maxwellian3d"])
def test_the_cooling_rate_follows_the_tolerance(name):
    scene = gs.load_scene(name, restitution=0.5, diffusion=0.0)
    solvers = [gs.fit_solver(scene, rtol) for rtol in (1e-2, 1e-3, 1e-4)]
    assert solvers[0].N < solvers[2].N and solvers[0].R < solvers[1].R < solvers[2].R
    for solver in solvers:
        operator = gs.collision_operator(scene, solver)
        f = scene.density(operator.grid)
        v2 = sum(v**2 for v in operator.grid.velocities())
        rate = np.sum(v2 * operator(f)) / np.sum(v2 * f)
        # dT/dt = −(1−e²)/4 T
        assert rate == pytest.approx(-(1 - 0.25) / 4, rel=4 * solver.rtol), operator.plan


def test_hotter_and_moving_gases_get_larger_boxes():
    radii = [
        gs.fit_solver(
            gs.load_scene("maxwellian2d", temperature=T, velocity=u, restitution=0.5), 1e-2
        ).R
        for T, u in ((0.5, (0.0, 0.0)), (2.0, (0.0, 0.0)), (2.0, (6.0, 0.0)))
    ]
    assert radii[0] * 1.8 < radii[1] < radii[0] * 2.2
    assert radii[2] > radii[1] + 1.5


def test_other_settings_are_kept():
    solver = gs.fit_solver(asymmetric_scene(2), 1e-2, variant="full", threads=1)
    assert (solver.variant, solver.threads, solver.rtol) == ("full", 1, 1e-2)
    with pytest.raises(ValueError, match="M_cir=8: rtol=0.01 chooses it"):
        gs.fit_solver(asymmetric_scene(2), 1e-2, M_cir=8)
    with pytest.raises(ValueError, match="rtol=2.0: must be a number between 0 and 1"):
        gs.fit_solver(asymmetric_scene(2), 2.0)


def test_a_density_that_does_not_vanish():
    scene = gs.Scene(2, lambda vx, vy: 1.0 / (1.0 + vx**2 + vy**2), gs.maxwell(2), 0.5)
    with pytest.raises(ValueError, match="does not vanish within R=1000"):
        gs.fit_solver(scene, 1e-2)


@pytest.mark.fault("L7")
@pytest.mark.parametrize(("name", "rtol"), [("maxwellian2d", 1e-6), ("bkw2d", 1e-5)])
def test_a_fitted_solver_makes_an_operator_or_the_refusal_says_why(name, rtol):
    scene = gs.load_scene(name, restitution=0.5)
    try:
        operator = gs.collision_operator(scene, gs.fit_solver(scene, rtol, threads=1))
    except ValueError as refusal:
        said = str(refusal)
        assert f"rtol={rtol!r}" in said and "take a larger" in said
        assert "aliasing keeps" not in said  # the grid was chosen so that it does not
    else:
        assert operator.plan.error <= rtol


@pytest.mark.parametrize("exponent", [0.0, 1.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_the_radius_leaves_out_the_tolerated_part_of_the_exchanged_energy(dim, exponent):
    """In a Maxwellian pairs beyond R exchange Γ((d+2+λ)/2, R²/4T)/Γ((d+2+λ)/2) of all energy."""
    kernel, T = gs.VHS(exponent, 1.0), 0.9
    scene = gs.load_scene(f"maxwellian{dim}d", kernel=kernel, temperature=T, restitution=0.5)

    def beyond(R):
        return gammaincc((dim + 2 + exponent) / 2, R**2 / (4 * T))

    for rtol in (1e-2, 1e-3):
        R = collision_radius(scene, rtol)
        # each pair of nodes counts at its own distance, within a step
        assert beyond(R + R_STEP) < rtol < beyond(R - 2 * R_STEP)
