"""What a grid does not see of an initial density."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.trust.flags import Trust
from granstudy.trust.initial_errors import true_start


def gaussian(v, T, centre=0.0):
    dim = len(v)
    c2 = sum((vi - centre * (i == 0)) ** 2 for i, vi in enumerate(v))
    return np.exp(-c2 / (2 * T)) / (2 * np.pi * T) ** (dim / 2)


def core(*v):
    """Half the mass within σ = 0.1."""
    return 0.5 * gaussian(v, 1.0) + 0.5 * gaussian(v, 0.01)


def beam(*v):
    """2% of the mass beyond the box of R = 8."""
    return 0.98 * gaussian(v, 1.0) + 0.02 * gaussian(v, 0.2, 12.0)


def plain(*v):
    return gaussian(v, 1.0)


def ball(*v):
    """Half the mass within σ = 0.06."""
    return 0.5 * gaussian(v, 1.0) + 0.5 * gaussian(v, 0.0036)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(
    ("density", "T", "tolerance"),
    [(core, 0.505, 2e-2), (beam, None, 1e-5), (plain, 1.0, 1e-9)],
)
def test_finer_nodes_and_twice_the_box_find_the_moments(dim, density, T, tolerance):
    scene = gs.Scene(dim, density, gs.maxwell(dim))
    found = true_start(scene, gs.VelocityGrid(dim, 32, 8.0))
    if density is beam:
        T = 0.98 + 0.02 * 0.2 + 0.98 * 0.02 * 12.0**2 / dim
    assert found.density == pytest.approx(1.0, rel=tolerance)
    assert found.temperature == pytest.approx(T, rel=tolerance)


@pytest.mark.fault("A9")
@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
@pytest.mark.parametrize("density", [core, beam])
def test_what_lies_between_the_nodes_or_beyond_the_box_is_not_trusted(density, frame):
    """The core gave T = 0.99 for 0.505, the beam T 60% off; both were trusted."""
    scene = gs.Scene(2, density, gs.maxwell(2), restitution=0.9)
    solver = gs.Solver(N=32, R=8.0, N_rho=8, M_cir=8)
    ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, frame=frame, progress=False)
    true = true_start(scene, gs.VelocityGrid(2, 64, 16.0)).temperature
    error = abs(float(ds["temperature"][0]) / true - 1.0)
    estimate = float(ds["temperature_error_estimate"][0])
    assert error > 0.1 and estimate == pytest.approx(error, rel=0.1)
    assert Trust(int(ds["trust"])) is Trust.UNTRUSTED


def test_a_radial_grid_is_examined_as_well():
    scene = gs.Scene(3, ball, gs.maxwell(3), restitution=0.9)
    solver = gs.Solver(N=24, R=8.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, progress=False)
    assert float(ds["temperature_error_estimate"][0]) > 0.1
    assert Trust(int(ds["trust"])) is Trust.UNTRUSTED


def test_a_density_that_ends_at_the_box_says_what_is_asked():
    def short(*v):
        if max(np.max(np.abs(vi)) for vi in v) > 9.0:
            raise ValueError("out of bounds")
        return gaussian(v, 1.0)

    def hollow(*v):
        return gaussian(v, 1.0) / (max(np.max(np.abs(vi)) for vi in v) < 9.0)

    for density, reason in (
        (short, "raises ValueError: out of bounds"),
        (hollow, "return 0 where"),
    ):
        scene = gs.Scene(2, density, gs.maxwell(2))
        with pytest.raises(ValueError, match=f"speeds up to 17.* {reason}"):
            gs.simulate(
                scene, gs.Solver(N=16, R=8.0, N_rho=4, M_cir=4), t_final=0.1, dt=0.1, progress=False
            )


def test_a_density_must_be_finite_at_every_node_that_is_asked_for():
    def broken(vx, vy):
        with np.errstate(invalid="ignore"):
            return np.exp(-(vx**2) - vy**2) * np.sqrt(np.where(vx > 10.0, -1.0, 1.0))

    with pytest.raises(ValueError, match="there it must be finite"):
        true_start(gs.Scene(2, broken, gs.maxwell(2)), gs.VelocityGrid(2, 16, 6.0))
