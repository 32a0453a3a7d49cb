"""The fast operator against the direct one, and what holds exactly."""

from dataclasses import replace

import numpy as np
import pytest
from comparison import (
    BOXES,
    assert_near,
    assert_spectral,
    asymmetric_scene,
    evaluate,
    relative_error,
)
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from scipy.signal import fftconvolve

import granstudy as gs
from granstudy.collision.carleman import operator as carleman
from granstudy.collision.fast import gain
from granstudy.collision.fast import operator as fast
from granstudy.collision.fast.operator import fast_operator, nodal_operator
from granstudy.collision.fourier import transforms
from granstudy.velocity.symmetry import apply

CONVERGED = {2: {"M_cir": 64, "N_rho": 24}, 3: {"M_sph": 302, "N_rho": 20}}
"""Nodes with which the quadrature error on `BOXES` is far under the aliasing."""

DEGREES = {6: 3, 26: 7, 50: 11, 86: 15, 110: 17, 146: 19, 194: 23, 302: 29}
"""Lebedev rules with their degree, in which their error is spectral."""


ONCE = (Phase.explicit, Phase.reuse, Phase.generate)
"""No shrinking: an example costs a second, and its parameters say all."""


def fast_Q(scene, **solver):
    nodes = CONVERGED[scene.dim] | {"sphere_rule": "lebedev"} | solver
    return evaluate(scene, **BOXES[scene.dim] | nodes)


def direct_Q(scene, **solver):
    return evaluate(scene, method="direct", **BOXES[scene.dim] | {"N_rho": None} | solver)


def radial(exponent):
    """The rule that is spectral for the exponent."""
    return "legendre" if float(exponent).is_integer() else "jacobi"


def wrapped(scene):
    """Σ|f̂_l||f̂_m| outside the spectrum, which wraps around it, over the same inside.

    The terms have signs and cancel: of 75 random scenes the error at converged rules was 0.16 of
    this at most, 0.01 to 0.05 for most.
    """
    grid = gs.VelocityGrid(scene.dim, **BOXES[scene.dim])
    f_hat = np.abs(np.fft.fftshift(np.fft.fftn(scene.density(grid))))
    products = fftconvolve(f_hat, f_hat)  # l+m from −N on
    largest = products.max()
    products[(slice(grid.N // 2, 3 * grid.N // 2),) * grid.dim] = 0.0
    return products.max() / largest


@pytest.fixture(scope="module", params=[(2, 0.0), (2, 0.5), (3, 1.0)], ids=str)
def resolved(request):
    """A scene without symmetry, its exact Q and the aliasing floor of its grid."""
    dim, exponent = request.param
    scene = asymmetric_scene(dim, seed=1, exponent=exponent, restitution=0.37)
    reference = direct_Q(scene)
    return scene, reference, 0.1 * wrapped(scene)


@pytest.mark.parametrize("variant", ["separate", "full"])
def test_error_falls_spectrally_with_the_directions(resolved, variant):
    scene, reference, floor = resolved
    rule = {"variant": variant, "radial_rule": radial(scene.kernel.exponent)}
    if scene.dim == 2:
        degrees = [4, 6, 8, 10, 12, 16, 20, 24, 32, 48]
        results = [fast_Q(scene, M_cir=M, **rule) for M in degrees]
    else:
        degrees = list(DEGREES.values())
        results = [fast_Q(scene, M_sph=M, **rule) for M in DEGREES]
    errors = [relative_error(Q, reference) for Q in results]
    assert_spectral(degrees, errors, rate=0.3, floor=floor)


@pytest.mark.parametrize("variant", ["separate", "full"])
def test_error_falls_spectrally_with_the_shells(resolved, variant):
    scene, reference, floor = resolved
    shells = [3, 4, 5, 6, 8, 10, 12, 16, 20]
    rule = {"variant": variant, "radial_rule": radial(scene.kernel.exponent)}
    errors = [relative_error(fast_Q(scene, N_rho=n, **rule), reference) for n in shells]
    assert_spectral(shells, errors, rate=0.4, floor=floor)


@settings(max_examples=6, deadline=None, phases=ONCE)
@given(
    seed=st.integers(0, 10**6),
    restitution=st.floats(0.0, 1.0),
    exponent=st.sampled_from([0.0, 1.0]) | st.floats(0.05, 0.95),
    variant=st.sampled_from(["full", "separate"]),
)
def test_any_scene_in_2d_agrees_with_direct(seed, restitution, exponent, variant):
    scene = asymmetric_scene(2, seed, exponent, restitution)
    reference = direct_Q(scene)
    Q = fast_Q(scene, variant=variant, radial_rule=radial(exponent))
    assert_near(Q, reference, 0.3 * wrapped(scene))


@settings(max_examples=3, deadline=None, phases=ONCE)
@given(
    seed=st.integers(0, 10**6),
    restitution=st.floats(0.0, 1.0),
    exponent=st.floats(0.05, 0.95),
)
def test_any_scene_in_3d_agrees_with_direct(seed, restitution, exponent):
    scene = asymmetric_scene(3, seed, exponent, restitution)
    reference = direct_Q(scene)
    Q = fast_Q(scene, radial_rule="jacobi")
    assert_near(Q, reference, 0.3 * wrapped(scene))


@pytest.mark.parametrize("dim", [2, 3])
def test_variants_agree_where_the_rule_has_converged(dim):
    # what is left of the gain's aliasing they share
    scene = asymmetric_scene(dim, seed=1, exponent=1.0)
    full, separate = (fast_Q(scene, variant=v) for v in ("full", "separate"))
    assert_near(full, separate, 1e-9 if dim == 2 else 1e-7)
    coarse = {"M_cir": 8, "M_sph": 26}
    full, separate = (fast_Q(scene, variant=v, **coarse) for v in ("full", "separate"))
    assert relative_error(full, separate) > 1e-4


@pytest.mark.parametrize("restitution", [0.3, gs.Viscoelastic(0.1)], ids=str)
@pytest.mark.parametrize("dim", [2, 3])
def test_results_do_not_depend_on_threads(dim, restitution):
    scene = asymmetric_scene(dim, seed=5, exponent=1.0, restitution=restitution)
    few = {"N": 8, "N_rho": 6, "M_cir": 10, "M_sph": 26}
    first, *others = (fast_Q(scene, **few, threads=threads) for threads in (1, 2, 3))
    for Q in others:
        assert np.array_equal(Q, first)


@pytest.mark.parametrize("dim", [2, 3])
def test_an_operator_is_called_often(dim):
    operator = gs.collision_operator(asymmetric_scene(dim), gs.Solver(N=8, R=5.0, N_rho=6))
    f = asymmetric_scene(dim, seed=2).density(operator.grid)
    kept = f.copy()
    first = operator(f)
    operator(2 * f)
    assert np.array_equal(operator(f), first)
    assert np.array_equal(f, kept)
    assert first.dtype == np.float64
    assert np.array_equal(operator(np.asfortranarray(f)), first)


def test_a_rule_without_antipodes_is_symmetrised():
    # 15 angles with their antipodes are the 30 of the even rule
    scene = asymmetric_scene(2)
    assert_near(fast_Q(scene, M_cir=15), fast_Q(scene, M_cir=30), 1e-6)
    assert relative_error(fast_Q(scene, M_cir=3), fast_Q(scene, M_cir=30)) > 1e-4


@pytest.mark.parametrize("restitution", [0.3, gs.Viscoelastic(0.1)], ids=str)
@pytest.mark.parametrize("dim", [2, 3])
def test_single_precision_differs_by_its_round_off(dim, restitution):
    scene = asymmetric_scene(dim, seed=5, exponent=1.0, restitution=restitution)
    few = {"N": 16, "N_rho": 8, "M_cir": 16, "M_sph": 26}
    single, double = (fast_Q(scene, **few, precision=p) for p in ("single", "double"))
    assert single.dtype == np.float64
    # beyond single precision's 6e-8, and not that of double
    assert 1e-9 < relative_error(single, double) < 2e-6


def test_single_precision_keeps_a_scenes_symmetry():
    scene = gs.load_scene("bkw3d", restitution=0.5)
    Q = fast_Q(scene, N=16, R=7.0, M_sph=26, sphere_rule="lebedev", precision="single")
    for h in scene.symmetry.generators:
        assert np.array_equal(apply(h, Q), Q)


@pytest.fixture
def counted(monkeypatch):
    """A function of how many transforms all plans have made since it was last called."""
    planned, before = [], 0

    class Counted(transforms.RealTransforms):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            planned.append(self)

    for module in (fast, gain, carleman):
        monkeypatch.setattr(module, "RealTransforms", Counted)

    def count():
        nonlocal before
        total = sum(each.made for each in planned)
        made, before = total - before, total
        return made

    return count


def on_points(n):
    """The maker of a sum with its products on n points a dimension."""
    return lambda scene, solver, grid, *sums: nodal_operator(
        scene, solver, gs.VelocityGrid(grid.dim, n, grid.R), *sums
    )


@pytest.mark.parametrize("n", [6, 8, 12, None])
def test_the_bare_transforms_are_those_of_one_evaluation(counted, n):
    """With products on fewer, as many and more points, and by `carleman`."""
    scene = asymmetric_scene(2, restitution=1.0)
    solver = gs.Solver(N=8, R=5.0, N_rho=3, M_cir=10).sized()
    if n is None:
        operator = gs.collision_operator(scene, replace(solver, method="carleman"))
    else:
        operator = fast_operator(scene, solver, on_points(n))
    f = scene.density(operator.grid)
    for make in (lambda: operator(f), operator.transform):
        counted()
        make()
        assert counted() == operator.transforms


@pytest.mark.parametrize(("dim", "pairs"), [(2, 15), (3, 16)])
def test_transforms_of_one_evaluation(counted, dim, pairs):
    solver = gs.Solver(N=8, R=5.0, N_rho=8, M_cir=30, M_sph=32)
    operator = gs.collision_operator(asymmetric_scene(dim), solver)
    counted()
    operator(asymmetric_scene(dim).density(operator.grid))
    # a forward and a backward transform a pair; f̂, the gain's sum and the loss
    assert counted() == operator.transforms == 2 * 8 * pairs + 3
    # half of what every node apart would take
    literal = gs.Solver(N=8, R=5.0, N_rho=8, M_cir=30, M_sph=32, method="literal")
    assert 2 * (operator.transforms - 3) == (
        gs.collision_operator(asymmetric_scene(dim), literal).transforms - 3
    )
