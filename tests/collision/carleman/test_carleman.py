"""The Carleman form: its weights, what holds exactly, and its limits."""

import numpy as np
import pytest
from comparison import assert_near, assert_spectral, asymmetric_scene, evaluate, relative_error
from scipy.integrate import dblquad

import granstudy as gs
from granstudy import theory
from granstudy.collision.carleman import operator as carleman
from granstudy.collision.carleman import scenes as carleman_scenes
from granstudy.collision.carleman import weights as carleman_weights
from granstudy.collision.choice.cost import estimate
from granstudy.collision.choice.method_costs import CARLEMAN
from granstudy.collision.rules import directions
from granstudy.model.densities import Bkw2D
from granstudy.quadrature import half

RESOLVED = {2: {"N": 48, "R": 8.0}, 3: {"N": 24, "R": 8.0}}
"""Grids on which `asymmetric_scene` has small tails and little aliasing."""

CONVERGED = {2: {"M_cir": 48}, 3: {"M_sph": 146, "sphere_rule": "lebedev"}}


def carleman_Q(scene, f=None, **solver):
    settings = RESOLVED[scene.dim] | CONVERGED[scene.dim] | {"method": "carleman"}
    return evaluate(scene, f, **settings | solver)


def direct_Q(scene, **solver):
    return evaluate(scene, method="direct", N_rho=None, **RESOLVED[scene.dim] | solver)


def maxwellian(dim, **changes):
    kernel = gs.hard_spheres(3) if dim == 3 else gs.maxwell(2)
    velocity = (0.3, -0.2, 0.1)[:dim]
    return gs.load_scene(
        f"maxwellian{dim}d",
        **{"kernel": kernel, "restitution": 1.0, "velocity": velocity} | changes,
    )


def moments_of(Q, grid):
    """∫ (1, v, |v|²) Q dv."""
    v = grid.velocities()
    first = [np.sum(vi * Q) for vi in v]
    return np.array([Q.sum(), *first, np.sum(sum(vi**2 for vi in v) * Q)]) * grid.cell


# The weights


@pytest.mark.parametrize(("dim", "exponent"), [(2, 0.0), (3, 1.0)])
def test_a_constant_kernel_separates(dim, exponent):
    kernel = gs.VHS(exponent, 0.3)
    assert carleman_scenes.is_separable(kernel, dim)
    a, q = np.linspace(0, 9, 7), np.linspace(0, 11, 8)
    product = np.outer(carleman_weights.normal(dim, 1.7, a), carleman_weights.tangent(dim, 1.7, q))
    product *= carleman_weights.strength(kernel, dim)
    assert_near(carleman_weights.kernel_weight(kernel, dim, 1.7, a, q), product, 1e-13)


@pytest.mark.parametrize("exponent", [0.5, 1.0])
def test_the_kernel_weight_is_its_integral(exponent):
    # 2D: K(a,q) = 2C ∫∫ |g|^λ cos ρa cos ρ'q over |ρ|, |ρ'| < r
    a, q, r = 1.3, 2.1, 1.5
    integral = dblquad(
        lambda y, x: np.hypot(x, y) ** exponent * np.cos(a * x) * np.cos(q * y), 0, r, 0, r
    )[0]
    K = carleman_weights.kernel_weight(gs.VHS(exponent, 0.25), 2, r, np.array([a]), np.array([q]))
    assert K[0, 0] == pytest.approx(2 * 0.25 * 4 * integral, rel=1e-7)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("e", [0.99, 0.8, 0.0])
def test_products_sum_to_the_displaced_weight(dim, e):
    grid = gs.VelocityGrid(dim, 16, 6.0)
    kernel = gs.VHS(dim - 2.0, 1.0)
    largest = np.pi / grid.L * grid.N / 2
    products = carleman_weights.products(kernel, e, grid, largest)
    a, b = np.linspace(0.1, largest, 41)[:, None], np.linspace(0.1, largest, 37)
    r, beta = carleman_scenes.reach(grid), (1 - e) / 4
    B = carleman_weights.strength(kernel, dim)
    scale = B * carleman_weights.normal(dim, r, np.zeros(1))[0]
    trust = carleman_weights.EDGE ** ((a / largest) ** 2 + (b / largest) ** 2)
    for side in (1.0, -1.0):  # m on either side of the plane across e
        found = sum(
            (side if p.odd else 1.0) * p.of_l(a) * p.of_m(b * np.ones((1, 1))) for p in products
        )
        exact = B * carleman_weights.normal(dim, r, (1 - 2 * beta) * a - 2 * beta * side * b)
        assert np.max(trust * np.abs(found - exact)) < 1.2 * carleman_weights.TOLERANCE * scale


def test_fewer_products_the_more_elastic():
    grid = gs.VelocityGrid(3, 32, 8.0)
    largest = np.pi / grid.L * grid.N / 2
    counts = [
        len(carleman_weights.products(gs.hard_spheres(3), e, grid, largest))
        for e in (1.0, 0.99, 0.95, 0.9, 0.8, 0.5)
    ]
    assert counts[0] == 1
    assert counts == sorted(counts)
    assert counts[2] <= 6 and counts[4] <= 9


# Against the direct method


@pytest.mark.parametrize(
    ("dim", "exponent", "e", "tolerance"),
    [
        (2, 0.0, 1.0, 1e-5),
        (2, 0.0, 0.95, 2e-5),
        (2, 0.0, 0.3, 2e-5),
        (2, 1.0, 1.0, 2e-5),
        (2, 0.4, 1.0, 2e-5),
        (3, 1.0, 1.0, 1.5e-3),
        (3, 1.0, 0.9, 1.5e-3),
        (3, 0.0, 1.0, 1.5e-3),
    ],
)
def test_any_density_in_the_ball_agrees_with_direct(dim, exponent, e, tolerance):
    scene = asymmetric_scene(dim, 1, exponent, e)
    reference = direct_Q(scene)
    for variant in ("full", "separate"):
        assert_near(carleman_Q(scene, variant=variant), reference, tolerance)


@pytest.mark.parametrize("variant", ["full", "separate"])
def test_error_falls_spectrally_with_the_directions(variant):
    scene = asymmetric_scene(2, 1, 0.0, 1.0)
    reference = direct_Q(scene)
    M = [4, 6, 8, 12, 16, 20, 24, 32, 40]
    errors = [relative_error(carleman_Q(scene, M_cir=m, variant=variant), reference) for m in M]
    assert_spectral(M, errors, rate=0.3, floor=1e-5)
    scene = asymmetric_scene(3, 1, 1.0, 1.0)
    converged = carleman_Q(scene, M_sph=302, variant=variant)
    degrees = {14: 5, 26: 7, 38: 9, 50: 11, 86: 15, 110: 17, 146: 19}
    errors = [
        relative_error(carleman_Q(scene, M_sph=m, variant=variant), converged) for m in degrees
    ]
    assert_spectral(list(degrees.values()), errors, rate=0.4, floor=1e-4)


# What holds exactly


@pytest.mark.parametrize(("dim", "sizes"), [(2, (16, 24, 32, 40)), (3, (8, 12, 16, 20, 24))])
def test_a_maxwellian_is_an_equilibrium(dim, sizes):
    errors = []
    for N in sizes:
        scene = maxwellian(dim)
        f = scene.density(gs.VelocityGrid(dim, N, 9.0))
        Q = carleman_Q(scene, f, N=N, R=9.0, M_sph=74, variant="full")
        errors.append(np.max(np.abs(Q)) / np.max(f))
    assert_spectral(sizes, errors, rate=0.3, floor=1e-6 if dim == 2 else 2e-3)


@pytest.mark.parametrize(
    ("dim", "exponent", "e"),
    [(2, 0.0, 1.0), (2, 0.0, 0.5), (2, 1.0, 1.0), (3, 1.0, 1.0), (3, 1.0, 0.9), (3, 0.3, 1.0)],
)
def test_mass_is_conserved_to_round_off(dim, exponent, e):
    # with few directions and a density that the grid does not resolve
    scene = asymmetric_scene(dim, 3, exponent, e)
    Q = carleman_Q(scene, N=10, R=5.0, M_cir=6, M_sph=14, variant="full")
    assert abs(Q.sum()) < 1e-13 * np.abs(Q).sum()


@pytest.mark.parametrize(("dim", "sizes"), [(2, (16, 24, 32, 40)), (3, (10, 14, 18, 22))])
def test_momentum_and_energy_are_conserved_spectrally(dim, sizes):
    scene = asymmetric_scene(dim, 1, dim - 2.0, 1.0)
    errors = []
    for N in sizes:
        Q = carleman_Q(scene, N=N, M_sph=50, variant="full")
        grid = gs.VelocityGrid(dim, N, RESOLVED[dim]["R"])
        errors.append(np.max(np.abs(moments_of(Q, grid))) / (np.abs(Q).sum() * grid.cell))
    assert_spectral(sizes, errors, rate=0.3, floor=1e-6 if dim == 2 else 1e-2)


@pytest.mark.parametrize("e", [0.95, 0.8])
def test_near_elastic_grains_cool_by_the_law(e):
    scene = maxwellian(3, restitution=e)
    operator = gs.collision_operator(
        scene, gs.Solver(N=24, R=9.0, method="carleman", M_sph=50, sphere_rule="lebedev")
    )
    cooling = moments_of(operator(scene.density(operator.grid)), operator.grid)[-1] / 3
    law = -theory.gaussian_cooling_coefficient(scene.kernel, e, 3)
    assert cooling == pytest.approx(law, abs=3e-4)


def test_elastic_is_the_limit():
    for dim in (2, 3):
        elastic, near = (
            carleman_Q(asymmetric_scene(dim, 1, dim - 2.0, e), N=16, M_sph=38, variant="full")
            for e in (1.0, 1.0 - 1e-9)
        )
        assert_near(near, elastic, 1e-7)


def test_the_octahedral_group():
    # exact with a rule that has it: the ball of modes has it too
    scene = asymmetric_scene(3, 1, 1.0, 1.0)
    f = scene.density(gs.VelocityGrid(3, 8, 5.0))
    small = {"N": 8, "R": 5.0, "M_sph": 26}
    Q = carleman_Q(scene, f, **small)
    for turn in (
        lambda h: np.rot90(h, axes=(0, 1)),
        lambda h: np.rot90(h, axes=(1, 2)),
        lambda h: h.transpose(2, 0, 1),
        lambda h: h[::-1],
    ):
        assert_near(carleman_Q(scene, turn(f).copy(), **small), turn(Q), 1e-12)
    assert relative_error(np.rot90(Q), Q) > 0.1


def bkw2d(v2, t):
    """f = e^{−v²/2K}/(2πK²) (2K − 1 + (1−K)/(2K) v²), K = 1 − e^{−t/8}/2, for B = 1/(2π), and ∂t f."""
    K = 1 - np.exp(-t / 8) / 2
    envelope = np.exp(-v2 / (2 * K)) / (2 * np.pi)
    polynomial = 2 * K - 1 + (1 - K) / (2 * K) * v2
    f = envelope * polynomial / K**2
    by_K = envelope * (polynomial * (v2 / (2 * K**4) - 2 / K**3) + (2 - v2 / (2 * K**2)) / K**2)
    return f, by_K * (1 - K) / 8


@pytest.mark.parametrize("variant", ["full", "separate"])
def test_the_exact_solution_of_elastic_maxwell_molecules(variant):
    scene = gs.Scene(dim=2, initial=Bkw2D(), kernel=gs.maxwell(2), restitution=1.0)
    solver = gs.Solver(N=48, R=8.0, M_cir=32, variant=variant, method="carleman")
    grid = solver.grid(2)
    v2 = sum(v**2 for v in grid.velocities())
    assert_near(scene.density(grid), bkw2d(v2, 0.5)[0], 1e-14)
    for t in (0.5, 2.0):
        f, rate = bkw2d(v2, t)
        assert_near(gs.collision_operator(scene, solver)(f), rate, 1e-5)
    ds = gs.simulate(scene, solver, t_final=1.0, dt=0.05, save_every=20)
    last = ds["f"].isel({ds["f"].dims[0]: -1}).values
    assert_near(last, bkw2d(v2, 1.5)[0], 1e-6)
    assert relative_error(scene.density(grid), last) > 0.05


# The operator


@pytest.mark.parametrize(("dim", "e"), [(2, 0.7), (3, 1.0)])
def test_results_do_not_depend_on_threads_or_on_earlier_calls(dim, e):
    scene = asymmetric_scene(dim, 5, dim - 2.0, e)
    few = {"N": 8, "R": 5.0, "M_cir": 10, "M_sph": 26}
    first, *others = (carleman_Q(scene, **few, threads=threads) for threads in (1, 2, 3))
    for Q in others:
        assert np.array_equal(Q, first)
    operator = gs.collision_operator(
        scene, gs.Solver(N=8, R=5.0, method="carleman", M_cir=10, M_sph=26, sphere_rule="lebedev")
    )
    f = scene.density(operator.grid)
    kept = f.copy()
    operator(2 * f)
    assert np.array_equal(operator(f), first)
    assert np.array_equal(f, kept)
    assert np.array_equal(operator(np.asfortranarray(f)), first)


@pytest.mark.parametrize(
    ("dim", "e", "rule", "pairs"),
    [(3, 1.0, {"M_sph": 32}, 16), (2, 1.0, {"M_cir": 30}, 15), (2, 1.0, {"M_cir": 32}, 8)],
)
def test_transforms_of_one_evaluation(dim, e, rule, pairs):
    scene = asymmetric_scene(dim, 1, dim - 2.0, e)
    operator = gs.collision_operator(scene, gs.Solver(N=8, R=5.0, method="carleman", **rule))
    assert operator.transforms == 2 * pairs + 2


def test_right_angles_halve_the_work_and_change_nothing(monkeypatch):
    scene = asymmetric_scene(2, 1, 1.0, 1.0)
    for rule in ({"M_cir": 8}, {"M_cir": 16, "variant": "full"}):
        quarter = carleman_Q(scene, **rule)
        with monkeypatch.context() as patch:
            patch.setattr(carleman, "half_rule", lambda s, solver: half(directions(s, solver)))
            assert_near(carleman_Q(scene, **rule), quarter, 1e-12)


@pytest.mark.parametrize("e", [1.0, 0.99, 0.9, 0.5])
@pytest.mark.parametrize(("dim", "exponent"), [(2, 0.0), (2, 1.0), (3, 1.0), (3, 0.0)])
def test_the_estimate_knows_the_transforms(dim, exponent, e):
    scene = asymmetric_scene(dim, 1, exponent, e)
    if e < 1.0 and exponent != dim - 2:
        return
    solver = gs.Solver(N=16, R=7.0, method="carleman", M_cir=30, M_sph=12).sized()
    made = gs.collision_operator(scene, solver).transforms
    assert 0.5 < CARLEMAN.transforms(scene, solver) / made < 2.0
    some, twice = (estimate(CARLEMAN, scene, solver, evaluations) for evaluations in (100, 200))
    assert twice.seconds - twice.setup == pytest.approx(2 * (some.seconds - some.setup))


# Wrong input


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        (
            {"restitution": 0.9, "exponent": 0.0, "dim": 3},
            "restitution=0.9 with exponent=0.0 in 3D: .* restitution below 1 only with exponent 1",
        ),
        ({"restitution": 0.9, "exponent": 1.0, "dim": 2}, "exponent=1.0 in 2D"),
        ({"restitution": gs.Viscoelastic(0.1), "dim": 2}, "'carleman' takes a constant"),
    ],
)
def test_scenes_it_cannot_do(scene, message):
    with pytest.raises(ValueError, match=message):
        gs.collision_operator(asymmetric_scene(**scene), gs.Solver(N=8, R=5.0, method="carleman"))


def test_densities_it_cannot_take():
    scene = asymmetric_scene(2, restitution=1.0)
    operator = gs.collision_operator(scene, gs.Solver(N=8, R=5.0, method="carleman"))
    f = scene.density(operator.grid)
    with pytest.raises(ValueError, match="type complex128: method 'carleman' takes real"):
        operator(f + 0j)
    with pytest.raises(ValueError, match=r"shape \(6, 6\): the grid's is \(8, 8\)"):
        operator(f[:6, :6])
    f[3, 3] = np.nan
    with pytest.raises(ValueError, match="NaN or infinite"):
        operator(f)


STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw3d}
    solver: {R: 7.0, N: 8, method: carleman}
    time: {t_final: 1.0, dt: 0.1}
    sweep:
      - {e: [1.0, 0.9]}
    table: {quantity: temperature}
"""


def test_a_study_is_told_before_any_work(load):
    with pytest.raises(ValueError, match=r"run e~0.9.*restitution=0.9 with exponent=0.0 in 3D"):
        load()
