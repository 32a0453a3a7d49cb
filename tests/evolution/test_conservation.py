"""Conservation by the least change: exact, orthogonal, idle where nothing drifts."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.collision import collision_operator
from granstudy.evolution.conservation import Projection
from granstudy.evolution.unknowns import collisions, representation

SCENE = gs.load_scene("double_well2d", restitution=0.5, diffusion=0.0)
STARVED = {"N": 24, "R": 8.0, "N_rho": 8, "M_cir": 6}


def drifting(method):
    """A density, and its Q from too few directions."""
    operator = collision_operator(SCENE, gs.Solver(**STARVED, method=method))
    form = representation(operator, SCENE.symmetry)
    f = form.state(SCENE.density(operator.grid))
    return form, f, collisions(operator)(f)


def moments(form, Q, names=("mass", "momentum", "energy")):
    phi = form.grid.invariants()
    Q = form.density(Q)
    return np.concatenate(
        [(phi[name] * form.grid.measure * Q).sum(axis=(-2, -1)) for name in names]
    )


@pytest.mark.parametrize("method", ["fast", "literal"])
@pytest.mark.parametrize(
    "conserve", [("mass",), ("mass", "momentum"), ("mass", "momentum", "energy")]
)
def test_what_is_conserved_vanishes_to_round_off(method, conserve):
    form, f, Q = drifting(method)
    project = Projection(form, conserve)
    assert np.max(np.abs(moments(form, Q, conserve))) > 1e-3
    corrected = project(f, Q)
    assert np.max(np.abs(moments(form, corrected, conserve))) < 1e-13
    # what already conserves is left as it is
    assert np.max(np.abs(project(f, corrected) - corrected)) < 1e-15


def test_the_change_is_the_least():
    """Over the Maxwellian it is orthogonal to all that conserves: any other correction is a larger one."""
    form, f, Q = drifting("fast")
    project = Projection(form, ("mass", "momentum"))
    m = form.grid.velocity_moments(f)
    T, u = np.trace(m.pressure) / (2 * m.density), m.momentum / m.density
    M = np.exp(-sum((v - w) ** 2 for v, w in zip(form.grid.velocities(), u, strict=True)) / (2 * T))
    change = (project(f, Q) - Q) / np.sqrt(M)
    noise = np.random.default_rng(1).normal(size=Q.shape) * M
    other = project(f, noise) / np.sqrt(M)
    assert np.linalg.norm(change) > 1e-3
    assert abs(np.sum(change * other)) < 1e-12 * np.linalg.norm(change) * np.linalg.norm(other)


def test_it_leaves_the_tail_alone():
    """The change has the fourth moment of the gas, not of the box."""
    form, f, Q = drifting("fast")
    change = Projection(form, ("mass",))(f, Q) - Q
    grid = form.grid
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    c4 = sum((v - w) ** 2 for v, w in zip(grid.velocities(), u, strict=True)) ** 2
    T = np.trace(m.pressure) / (2 * m.density)
    assert np.sum(c4 * change) / np.sum(change) == pytest.approx(8 * T**2, rel=1e-2)


def test_a_radial_grid_weighs_its_nodes_and_has_no_momentum():
    scene = gs.load_scene("bkw3d", restitution=1.0)
    operator = collision_operator(scene, gs.Solver(N=24, R=7.0, method="radial"))
    form = representation(operator, scene.symmetry)
    grid = form.grid
    f = scene.density(grid)
    Q = np.random.default_rng(2).normal(size=24) * np.exp(-grid.nodes)
    corrected = Projection(form, ("mass", "momentum", "energy"))(f, Q)
    assert abs(grid.weights @ Q) > 1e-2
    assert abs(grid.weights @ corrected) < 1e-12
    assert abs(grid.weights @ (grid.nodes**2 * corrected)) < 1e-11


@pytest.mark.parametrize("method", ["fast", "literal"])
@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
def test_a_run_keeps_what_it_conserves_and_records_the_drift_where_not(method, frame):
    solver = gs.Solver(**STARVED, method=method)
    time = {"t_final": 0.5, "dt": 0.05, "frame": frame, "progress": False}
    free = gs.simulate(SCENE, solver, **time)
    kept = gs.simulate(SCENE, solver, conserve=("momentum", "mass"), **time)
    assert abs(float(free["density"][-1] / free["density"][0]) - 1.0) > 1e-3
    assert abs(float(kept["density"][-1] / kept["density"][0]) - 1.0) < 1e-13
    assert float(abs(kept["velocity"][-1] - kept["velocity"][0]).max()) < 1e-12
    assert float(abs(free["velocity"][-1] - free["velocity"][0]).max()) > 1e-5
    assert (
        str(kept["conserve"].values) == "mass-momentum" and str(free["conserve"].values) == "none"
    )
    assert kept["temperature_error"][-1] < free["temperature_error"][-1]


def test_elastic_energy():
    scene = gs.load_scene("double_well2d", restitution=1.0, diffusion=0.0)
    everything = ("mass", "momentum", "energy")
    ds = gs.simulate(
        scene, gs.Solver(**STARVED), t_final=0.5, dt=0.1, conserve=everything, progress=False
    )
    assert float(abs(ds["energy"] - ds["energy"][0]).max()) < 1e-13


def test_the_energy_that_collisions_take_is_that_of_all_pairs():
    """T of Maxwell molecules then follows the exact law, with however few directions."""
    everything = ("mass", "momentum", "energy")
    time = {"t_final": 1.0, "dt": 0.05, "progress": False}
    for frame in ("fixed", "rescaled"):
        kept = gs.simulate(SCENE, gs.Solver(**STARVED), conserve=everything, frame=frame, **time)
        free = gs.simulate(SCENE, gs.Solver(**STARVED), conserve=("mass",), frame=frame, **time)
        assert float(kept["temperature_error"][-1]) < 1e-6 < 1e-3 < free["temperature_error"][-1]
    scene = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1))
    with pytest.raises(ValueError, match="not energy where frame='rescaled' changes the scale of"):
        gs.simulate(scene, gs.Solver(**STARVED), conserve=everything, frame="rescaled", **time)
