"""States against sums of Gaussians, computed apart from this package and exact to about 1e-7."""

import pytest

import granstudy as gs

COOLING = [
    # dim, λ, e, a2, a3, N, R, error of a3 that the tail beyond the box allows
    (3, 1.0, 0.4, 0.0757089, -0.0253459, 40, 12.0, 1e-6),
    (2, 1.0, 0.0, 0.1817736, -0.1045800, 64, 16.0, 1e-6),
    pytest.param(3, 0.5, 0.2, 0.2565336, -0.314944, 96, 22.0, 1e-4, marks=pytest.mark.slow),
    pytest.param(3, 0.25, 0.5, 0.172915, -0.17721, 96, 22.0, 1e-4, marks=pytest.mark.slow),
]


def gas(dim, exponent, e, diffusion=0.0):
    kernel = gs.VHS(exponent, gs.hard_spheres(dim).strength)
    return gs.load_scene(f"maxwellian{dim}d", kernel=kernel, e=e, diffusion=diffusion)


@pytest.mark.fault("D5")
@pytest.mark.parametrize(("dim", "exponent", "e", "a2", "a3", "N", "R", "tail"), COOLING)
def test_cooling_states(dim, exponent, e, a2, a3, N, R, tail):
    ds = gs.cooling_state(gas(dim, exponent, e), gs.Solver(N=N, R=R, method="radial"))
    assert float(ds["a2"]) == pytest.approx(a2, abs=1e-6)
    assert float(ds["a3"]) == pytest.approx(a3, abs=tail)


@pytest.mark.fault("D5")
@pytest.mark.parametrize(
    ("e", "a2", "a3"), [(0.4, 0.0370477, -0.0036953), (0.95, -0.0091929, None)]
)
def test_heated_states_of_hard_spheres(e, a2, a3):
    ds = gs.heated_state(gas(3, 1.0, e, 0.1), gs.Solver(N=40, R=12.0, method="radial"))
    assert float(ds["a2"]) == pytest.approx(a2, abs=1e-6)
    assert a3 is None or float(ds["a3"]) == pytest.approx(a3, abs=1e-6)
