"""The radial method against direct, exact laws and exact solutions, and in N."""

import numpy as np
import pytest
from comparison import assert_near, assert_spectral, evaluate, relative_error

import granstudy as gs
from granstudy import theory
from granstudy.collision.radial import operator as radial
from granstudy.collision.radial import tensor as radial_tensor
from granstudy.reading.cooling import fit_haff
from granstudy.velocity.sphere import sphere_mean


class Isotropic:
    """A density far from equilibrium, (1 + b v²/T) e^{−v²/2T}."""

    def __init__(self, temperature=1.0, b=0.3):
        self.temperature, self.b = temperature, b

    def __call__(self, *v):
        v2 = sum(vi**2 for vi in v) / self.temperature
        return (1 + self.b * v2) * np.exp(-v2 / 2)


def random_scene(dim, seed, **density):
    """A scene with random e and λ."""
    e, exponent = np.random.default_rng(seed).uniform(size=2)
    kernel = gs.VHS(exponent, gs.maxwell(dim).strength)
    return gs.Scene(dim=dim, initial=Isotropic(**density), kernel=kernel, restitution=e)


@pytest.mark.parametrize(
    ("dim", "seed", "N", "R", "tolerance"),
    [(2, 0, 40, 7.5, 1e-7), (2, 1, 40, 7.5, 1e-7), (3, 2, 20, 5.6, 5e-5), (3, 3, 20, 5.6, 5e-5)],
)
def test_it_equals_direct_on_the_cartesian_grid(dim, seed, N, R, tolerance):
    """To the tails of f at the box's faces, where the periodic images of the two methods differ."""
    scene = random_scene(dim, seed)
    direct = gs.collision_operator(scene, gs.Solver(N=N, R=R, method="direct", N_rho=None))
    reference = direct(scene.density(direct.grid))
    operator = gs.collision_operator(scene, gs.Solver(N=N, R=R, method="radial"))
    Q = operator(scene.density(operator.grid))
    assert_near(operator.grid.to_cartesian(Q, direct.grid), reference, tolerance)


@pytest.mark.parametrize("dim", [2, 3])
def test_it_converges_spectrally_in_N(dim):
    scene, speeds = random_scene(dim, 4), np.linspace(0.0, 8.0, 60)

    def values(N):
        operator = gs.collision_operator(scene, gs.Solver(N=N, R=8.0, method="radial"))
        return operator.grid.evaluate(operator(scene.density(operator.grid)), speeds)

    reference, sizes = values(40), [10, 14, 18, 22, 26, 30, 34]
    errors = [relative_error(values(N), reference) for N in sizes]
    assert_spectral(sizes, errors, 0.5, 1e-8)


@pytest.mark.parametrize(("dim", "seed"), [(2, 5), (2, 6), (3, 7), (3, 8)])
def test_a_gaussian_cools_at_the_exact_rate(dim, seed):
    scene = random_scene(dim, seed, temperature=0.7, b=0.0)
    operator = gs.collision_operator(scene, gs.Solver(N=36, R=9.0, method="radial"))
    f = scene.density(operator.grid)
    f /= operator.grid.velocity_moments(f).density
    rate = operator.grid.velocity_moments(operator(f)).energy * 2 / dim
    K = theory.gaussian_cooling_coefficient(scene.kernel, scene.restitution, dim)
    assert rate == pytest.approx(-K * 0.7 ** (1 + scene.kernel.exponent / 2), rel=1e-9)


@pytest.mark.parametrize(("e", "exponent"), [(0.0, 0.5), (1.0, 0.3)])
@pytest.mark.parametrize("dim", [2, 3])
def test_its_quadrature_is_exact_to_round_off(dim, e, exponent, monkeypatch):
    grid = gs.RadialGrid(dim, 20, 1.0)
    C = radial_tensor.mode_tensor(grid, exponent, e)
    monkeypatch.setattr(radial_tensor, "SPARE_NODES", 2 * radial_tensor.SPARE_NODES)
    assert_near(C, radial_tensor.mode_tensor(grid, exponent, e), 1e-13)


@pytest.mark.parametrize("dim", [2, 3])
def test_mass_is_conserved_to_round_off_for_any_values(dim):
    operator = gs.collision_operator(random_scene(dim, 9), gs.Solver(N=24, R=7.0, method="radial"))
    f = np.random.default_rng(0).uniform(size=24)
    Q = operator(f)
    w = operator.grid.weights
    assert abs(w @ Q) < 1e-12 * (w @ np.abs(Q))


@pytest.mark.parametrize(("dim", "exponent"), [(2, 0.0), (2, 0.6), (3, 0.4), (3, 1.0)])
def test_elastic_collisions_conserve_energy_and_keep_a_maxwellian(dim, exponent):
    kernel = gs.VHS(exponent, gs.maxwell(dim).strength)
    solver = {"N": 40, "R": 8.5, "method": "radial"}
    scene = gs.Scene(dim=dim, initial=Isotropic(), kernel=kernel, restitution=1.0)
    grid = gs.RadialGrid(dim, 40, 8.5)
    Q = evaluate(scene, **solver)
    assert relative_error(Q, 0 * Q + 1) > 0.1  # it is not in equilibrium
    energy = 0.5 * grid.weights * grid.nodes**2
    assert abs(energy @ Q) < 1e-9 * (energy @ np.abs(Q))
    maxwellian = gs.load_scene(f"maxwellian{dim}d", kernel=kernel, restitution=1.0)
    operator = gs.collision_operator(maxwellian, gs.Solver(**solver))
    f = maxwellian.density(operator.grid)
    # truncation at R leaves gain and loss of equal sums: in equilibrium they still cancel
    assert np.max(np.abs(operator(f))) < 1e-10 * np.max(f)


@pytest.mark.parametrize(("dim", "time", "rate"), [(2, 0.5, 1 / 8), (3, 6.5, 1 / 6)])
def test_elastic_maxwell_molecules_follow_the_bkw_solution(dim, time, rate):
    """Its K = 1 − exp(−t/8)/2 in 2D, 1 − exp(−t/6) in 3D, from the time of the paper's initial density."""
    scene = gs.load_scene(f"bkw{dim}d", restitution=1.0, diffusion=0.0)
    solver = gs.Solver(N=40, R=9.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=1.0, dt=0.02, save_every=50, progress=False)
    K = 1.0 - np.exp(-rate * (time + 1.0)) / (2.0 if dim == 2 else 1.0)
    r2 = ds["r"] ** 2
    c0, c2 = (
        ((2 * K - 1) / K, (1 - K) / (2 * K**2))
        if dim == 2
        else ((5 * K - 3) / (2 * K), (1 - K) / (2 * K**2))
    )
    exact = np.exp(-r2 / (2 * K)) * (c0 + c2 * r2) / (2 * np.pi * K) ** (dim / 2)
    assert_near(ds["f"].values[-1], exact.values, 1e-7)


@pytest.mark.parametrize(("dim", "e", "epsilon"), [(2, 0.3, 0.0), (3, 0.2, 0.05), (2, 1.0, 0.03)])
def test_maxwell_molecules_follow_the_exact_temperature_law(dim, e, epsilon):
    scene = gs.load_scene(f"bkw{dim}d", restitution=e, diffusion=epsilon)
    solver = gs.Solver(N=40, R=10.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=2.0, dt=0.02, progress=False)
    assert float(ds["temperature_error"].max()) < 2e-8
    assert float(abs(ds["density"] - ds["density"][0]).max()) < 1e-11
    assert int(ds["status"]) == 0 and ds["status"].attrs["warnings"] == ""


@pytest.mark.parametrize(("e", "C0"), [(0.8, 0.190584), (0.2, 0.51597)])
def test_hard_spheres_cool_by_haffs_law(e, C0):
    """The paper's Figure 4 without its bulk velocity; C0 from Cartesian runs at the same R."""
    scene = gs.load_scene(
        "maxwellian3d", temperature=2.0, kernel=gs.hard_spheres(3), restitution=e, diffusion=0.0
    )
    solver = gs.Solver(N=32, R=8.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=3.0, dt=0.01, progress=False)
    assert fit_haff(ds["time"].values, ds["temperature"].values).C0 == pytest.approx(C0, rel=2e-4)


def test_the_dataset_is_over_the_radial_speed(tmp_path):
    scene = gs.load_scene("bkw3d", restitution=0.5)
    solver = gs.Solver(N=17, R=7.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=0.2, dt=0.1, save_every=1, progress=False)
    assert ds["f"].dims == ("snapshot", "r")
    grid = gs.RadialGrid(3, 17, 7.0)
    np.testing.assert_array_equal(ds["r"], grid.nodes)
    np.testing.assert_allclose(ds["f"] @ ds["r_weight"], ds["density"])
    assert (int(ds["N"]), str(ds["method"].values)) == (17, "radial")
    gs.write_dataset(ds, tmp_path / "run.nc")
    assert gs.read_dataset(tmp_path / "run.nc")["f"].equals(ds["f"])


def test_one_call_is_a_bilinear_form_of_half_N_cubed_terms():
    operator = gs.collision_operator(random_scene(3, 0), gs.Solver(N=16, R=7.0, method="radial"))
    assert operator.tensor.shape == (16 * 17 // 2, 16)
    assert operator.transforms == 0


REFUSED = [
    (gs.load_scene("double_well2d"), "isotropic about v = 0; at |v| = "),
    (gs.load_scene("maxwellian3d", velocity=(0.0, 0.0, 0.01)), "isotropic about v = 0; at |v| = "),
    (gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1)), "restitution=Viscoelastic"),
    (gs.Scene(dim=2, initial=lambda x, y: x[:, 0], kernel=gs.maxwell(2)), "of the shape of its"),
    (gs.Scene(dim=2, initial=lambda x, y: x * np.nan, kernel=gs.maxwell(2)), "NaN or infinite"),
]


@pytest.mark.parametrize(("scene", "message"), REFUSED)
def test_scenes_that_are_not_isotropic_are_refused_before_any_work(scene, message, monkeypatch):
    monkeypatch.setattr(radial, "cached_array", None)
    with pytest.raises(ValueError) as error:
        gs.simulate(scene, gs.Solver(N=16, R=7.0, method="radial"), t_final=1.0, dt=0.1)
    assert message in str(error.value)


def test_states_and_settings_it_cannot_take():
    for N in (3, 16.0, True):
        with pytest.raises(
            ValueError, match=f"N={N}: must be an integer of at least 4, the number"
        ):
            gs.Solver(N=N, R=7.0, method="radial")
    operator = gs.collision_operator(random_scene(2, 0), gs.Solver(N=9, R=7.0, method="radial"))
    with pytest.raises(ValueError, match=r"shape \(8,\): the grid's is \(9,\)"):
        operator(np.ones(8))
    with pytest.raises(ValueError, match="NaN or infinite"):
        operator(np.full(9, np.nan))
    with pytest.raises(ValueError, match="method 'radial' takes real densities"):
        operator(np.ones(9, dtype=complex))


def test_the_tensor_is_computed_once_whatever_R_strength_and_heating(monkeypatch, tmp_path):
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path))
    computed = []

    def compute(*parameters):
        computed.append(parameters)
        return radial_tensor.unit_tensor(*parameters)

    monkeypatch.setattr(radial, "unit_tensor", compute)
    for R, strength, epsilon in ((7.0, 1.0, 0.0), (8.0, 2.0, 0.1), (7.0, 1.0, 0.0)):
        scene = gs.load_scene("bkw2d", kernel=gs.VHS(0.5, strength), diffusion=epsilon)
        Q = evaluate(scene, N=10, R=R, method="radial")
    assert computed == [(2, 10, 0.5, 1.0, computed[0][-1])]
    grid = gs.RadialGrid(2, 10, 7.0)
    # by dimension from another box: f(v/s) has Q s^{d+λ} times as large
    wide = gs.Scene(
        dim=2, initial=lambda *v: scene.initial(*(vi / 2 for vi in v)), kernel=scene.kernel
    )
    assert_near(evaluate(wide, N=10, R=14.0, method="radial"), 2**2.5 * Q, 1e-13)
    assert grid.shape == Q.shape


def test_the_tensors_name_holds_all_that_it_depends_on(monkeypatch):
    point = (2, 10, 0.5, 0.2)
    others = [(3, 10, 0.5, 0.2), (2, 11, 0.5, 0.2), (2, 10, 0.25, 0.2), (2, 10, 0.5, 0.2 + 1e-16)]
    names = {radial.tensor_name(*p) for p in [point, *others]}
    assert len(names) == 5
    for function, answer in (("fingerprint", lambda modules: "0"), ("version", lambda name: "9")):
        radial._code.cache_clear()
        with monkeypatch.context() as patch:
            patch.setattr(radial, function, answer)
            assert radial.tensor_name(*point) not in names
    radial._code.cache_clear()
    assert radial.tensor_name(*point) in names


@pytest.mark.parametrize(("dim", "e", "exponent"), [(2, 0.0, 0.3), (3, 0.7, 1.0), (2, 1.0, 0.0)])
def test_weights_on_tables_are_those_of_the_quadrature(dim, e, exponent):
    """C[n, m, i] by sums over the rules themselves, where `mode_tensor` interpolates."""
    grid = gs.RadialGrid(dim, 16, 1.0)
    C = radial_tensor.mode_tensor(grid, exponent, e)
    p, w_p = radial_tensor.shell_rule(grid, exponent)
    a = (1.0 + e) / 4.0

    def H(x, y):
        M = [sphere_mean(dim, np.multiply.outer(z, p)) for z in np.broadcast_arrays(x, y)]
        return (M[0] * M[1]) @ w_p

    for n, m in ((0, 0), (3, 3), (2, 15), (15, 15)):
        mu, w = radial_tensor.angle_rule(grid, n)
        l, k_m = grid.wavenumbers[[n, m]]  # noqa: E741
        k2 = np.maximum(l**2 + k_m**2 + 2 * l * k_m * mu, 0.0)
        G = -H(0.0, l) - H(0.0, k_m)
        for x, y in ((l, k_m), (k_m, l)):
            rest = (1 - a) * y**2 + a * x**2 - a * (1 - a) * k2
            G = G + H(a * np.sqrt(k2), np.sqrt(np.maximum(rest, 0.0)))
        waves = sphere_mean(dim, np.multiply.outer(np.sqrt(k2), grid.nodes))
        assert_near(C[n, m], 0.5 * (w * G) @ waves, 1e-13)


def test_its_derivative_is_that_of_the_form():
    operator = gs.collision_operator(random_scene(3, 5), gs.Solver(N=12, R=7.0, method="radial"))
    f, h = np.random.default_rng(1).uniform(size=(2, 12))
    expected = operator(f + h) - operator(f - h)
    assert_near(2.0 * operator.derivative(f) @ h, expected, 1e-12)


def test_large_tensors_are_not_kept(monkeypatch):
    monkeypatch.setattr(radial, "LARGEST_KEPT", 9)
    monkeypatch.setattr(radial, "cached_array", None)
    Q = evaluate(random_scene(3, 5), N=10, R=7.0, method="radial")
    assert Q.shape == (10,)
