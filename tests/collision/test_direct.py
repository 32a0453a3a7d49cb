"""The direct method against the literal one, and its two weights against each other."""

import numpy as np
import pytest
from comparison import assert_near, asymmetric_scene, evaluate

import granstudy as gs


@pytest.mark.parametrize(
    ("dim", "N", "M"), [(2, 16, {"M_cir": 60}), (3, 8, {"M_sph": 590, "sphere_rule": "lebedev"})]
)
@pytest.mark.parametrize("e", [0.0, 0.3, 1.0])
@pytest.mark.usefixtures("exact_sinc")
def test_circular_sums_equal_the_literal_method_at_a_converged_angular_rule(dim, N, M, e):
    scene = asymmetric_scene(dim, exponent=1.0, restitution=e)
    settings = {"N": N, "R": 6.0, "N_rho": 20}
    reference = evaluate(scene, method="direct", circular=True, **settings)
    literal = evaluate(scene, method="literal", variant="separate", **settings, **M)
    assert_near(literal, reference, 1e-9)


@pytest.mark.parametrize(("dim", "N"), [(2, 12), (3, 6)])
@pytest.mark.usefixtures("exact_sinc")
def test_the_series_for_variable_restitution_equals_the_scalar_table(dim, N):
    for e in (0.2, 0.9):
        constant = asymmetric_scene(dim, exponent=0.5, restitution=e)
        law = asymmetric_scene(dim, exponent=0.5, restitution=lambda v, e=e: e + 0 * v)
        settings = {"N": N, "R": 6.0, "N_rho": 12, "method": "direct"}
        for circular in (True, False):
            table = evaluate(constant, circular=circular, **settings)
            assert_near(evaluate(law, circular=circular, **settings), table, 1e-11)


def test_the_solvers_radial_rule_converges_to_the_converged_one():
    scene = asymmetric_scene(3, exponent=1.0)
    settings = {"N": 8, "R": 6.0, "method": "direct"}
    converged = evaluate(scene, N_rho=None, **settings)
    assert_near(evaluate(scene, N_rho=24, **settings), converged, 1e-11)
    with pytest.raises(AssertionError):
        assert_near(evaluate(scene, N_rho=6, **settings), converged, 1e-6)


def test_mass_is_conserved_and_the_state_keeps_its_type():
    scene = asymmetric_scene(2)
    solver = gs.Solver(N=16, R=6.0, method="direct", N_rho=None)
    operator = gs.collision_operator(scene, solver)
    f = scene.density(operator.grid)
    Q = operator(f)
    assert Q.dtype == np.float64
    assert abs(Q.sum()) < 1e-12 * np.abs(Q).sum()
    assert operator(f.astype(complex)).dtype == np.complex128


@pytest.mark.parametrize("restitution", [0.5, lambda v: 0.5 + 0 * v], ids=["constant", "law"])
def test_modes_whose_sum_lies_beyond_the_spectrum_give_nothing(restitution):
    """Of −4 and −1 on 8 points −2 is a sum within the spectrum. −5 comes around as 3; −8 as 0, the mass."""
    scene = asymmetric_scene(2, exponent=1.0, restitution=restitution)
    for circular, modes in ((False, {-2}), (True, {-2, 3})):
        solver = gs.Solver(N=8, R=6.0, method="direct", N_rho=8, circular=circular)
        operator = gs.collision_operator(scene, solver)
        phase = np.pi / operator.grid.L * operator.grid.velocities()[0] * np.ones((8, 8))
        Q_hat = np.abs(np.fft.fft2(operator(np.exp(-4j * phase) + np.exp(-1j * phase))))
        k = operator.grid.wavenumbers
        found = {(int(k[i]), int(k[j])) for i, j in np.argwhere(Q_hat > 1e-6 * Q_hat.max())}
        assert found == {(mode, 0) for mode in modes}
