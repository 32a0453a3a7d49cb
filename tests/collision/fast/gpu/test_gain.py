"""The sum over nodes in whole arrays against the compiled one, on every device that is there."""

import math
import tracemalloc
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from comparison import assert_near, asymmetric_scene
from devices import DEVICES, NUMPY

import granstudy as gs
from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.collision.fast.gpu.gain import SPECTRA_HELD, DeviceGainSum, equal_batches
from granstudy.collision.fast.gpu.operator import operator_on as on
from granstudy.collision.fast.gpu.transforms import DeviceResize
from granstudy.collision.fast.operator import fast_operator, nodal_operator
from granstudy.collision.fourier.spectra import resize

ROUND_OFF = {"double": 1e-13, "single": 1e-6}

SCENES = {
    "2D": (asymmetric_scene(2, seed=1, exponent=0.5, restitution=0.37), {"M_cir": 10}),
    "3D": (asymmetric_scene(3, seed=1, exponent=1.0, restitution=0.37), {"M_sph": 26}),
    "square": (gs.load_scene("bkw2d", restitution=0.0), {"M_cir": 16}),
    "octahedral": (gs.load_scene("bkw3d", restitution=1.0), {"M_sph": 50}),
    "exchange": (gs.load_scene("double_well3d", restitution=0.3), {"M_sph": 26}),
}


@pytest.fixture(params=DEVICES)
def device(request):
    return DEVICES[request.param]()


def small(rule, **settings):
    # few points: these densities are not resolved, so that unpaired modes are large
    return gs.Solver(
        **{"N": 12, "R": 7.0, "N_rho": 5, "sphere_rule": "lebedev"} | rule | settings, threads=1
    ).sized()


def on_points(n, make):
    """The maker of an operator with its products on n points per dimension."""
    return lambda scene, solver, grid, *sums: make(
        scene, solver, gs.VelocityGrid(grid.dim, n, grid.R), *sums
    )


@pytest.mark.parametrize("precision", ROUND_OFF)
@pytest.mark.parametrize("case", SCENES)
def test_equal_to_the_compiled_sum(device, case, precision):
    scene, rule = SCENES[case]
    solver = small(rule)
    compiled = fast_operator(scene, solver)
    operator = fast_operator(scene, replace(solver, precision=precision), on(device))
    f = scene.density(operator.grid)
    Q = operator(f)
    assert Q.dtype == np.float64
    # near an equilibrium Q is what is left of gain and loss, whose round-off it has
    error = np.max(np.abs(Q - compiled(f))) / np.max(np.abs(compiled.loss(f)))
    assert error < ROUND_OFF[precision]
    assert (error > 1e-10) == (precision == "single")
    assert operator.transforms == compiled.transforms
    assert (len(operator.group) > 1) == (case not in ("2D", "3D"))


def test_the_full_variant_keeps_the_mass(device):
    scene, rule = SCENES["3D"]
    operator = fast_operator(scene, small(rule, variant="full"), on(device))
    Q = operator(scene.density(operator.grid))
    assert abs(Q.sum()) < 1e-13 * np.abs(Q).sum()


@pytest.mark.parametrize("case", ["2D", "square"])
def test_a_planned_quadrature(device, case):
    scene, _ = SCENES[case]
    solver = gs.Solver(N=32, R=7.0, rtol=1e-2, threads=1).sized()
    compiled = AdaptiveOperator(scene, solver)
    adaptive = AdaptiveOperator(scene, solver, on(device))
    f = scene.density(compiled.grid)
    assert adaptive.plan == compiled.plan
    assert isinstance(adaptive.operator.gain, DeviceGainSum)
    assert_near(adaptive(f), compiled(f), 1e-13)
    assert adaptive.check(f) == pytest.approx(compiled.check(f), rel=1e-8)
    assert adaptive.tune(f) == compiled.plan


@pytest.mark.parametrize("n", [8, 12, 18])
@pytest.mark.parametrize("case", ["2D", "3D"])
def test_products_on_fewer_and_on_more_points(device, case, n):
    scene, rule = SCENES[case]
    solver = small(rule)

    operator, compiled = (
        fast_operator(scene, solver, on_points(n, make)) for make in (on(device), nodal_operator)
    )
    f = scene.density(operator.grid)
    assert operator.gain.grid.N == n
    assert_near(operator(f), compiled(f), 1e-13)
    assert_near(operator.loss(f), compiled.loss(f), 1e-14)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("n", [8, 12, 18])
def test_a_spectrum_on_another_grid(device, dim, n):
    f_hat = np.fft.rfftn(np.random.default_rng(1).normal(size=(12, 12 if dim == 3 else 1, 12)))
    resized = device.fetch(DeviceResize(device, dim, 12, n)(device.put(f_hat)))
    expected = resize(f_hat, n)
    if n == 12:  # where resize returns all modes
        expected[6], expected[..., 6] = 0.0, 0.0
        if dim == 3:
            expected[:, 6] = 0.0
    assert_near(resized, expected, 1e-14)


def test_batches_change_nothing(device):
    scene, rule = SCENES["3D"]
    solver = small(rule)
    f = scene.density(solver.grid(3))
    whole = fast_operator(scene, solver, on(device))(f)
    spectrum = 16 * 12 * 12 * 7
    for held in (0, 3, 7, 64):
        operator = fast_operator(scene, solver, on(device, memory=SPECTRA_HELD * spectrum * held))
        assert len(operator.gain._batches) == math.ceil(5 * 13 / max(1, held))
        assert_near(operator(f), whole, 1e-13)


@pytest.mark.parametrize("largest", [1, 7, 64, 1000])
@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 570])
def test_batches_are_equal_and_cover_all_nodes(count, largest):
    batches = equal_batches(count, largest)
    assert len(batches) == math.ceil(count / largest)
    assert [i for part in batches for i in range(count)[part]] == list(range(count))
    sizes = [part.stop - part.start for part in batches]
    assert not sizes or (max(sizes) <= largest and max(sizes) - min(sizes) <= 1)


@pytest.mark.parametrize("precision", ROUND_OFF)
def test_a_batch_takes_no_more_memory_than_it_may(precision):
    scene, rule = SCENES["3D"]
    operator = fast_operator(scene, small(rule, N=16, precision=precision), on(NUMPY, memory=2**22))
    assert len(operator.gain._batches) > 2
    f = scene.density(operator.grid)
    f_hat = np.fft.rfftn(f, norm="forward")
    operator.gain.total(f, f_hat)
    tracemalloc.start()
    operator.gain.total(f, f_hat)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # beside it what a call moves: f, f̂ and the sum
    assert 2**20 < peak < 2**22 + 4 * f_hat.nbytes


def test_transforms_alone(device):
    scene, rule = SCENES["3D"]
    operator = fast_operator(scene, small(rule), on(device))
    f = scene.density(operator.grid)
    before = operator(f)
    operator.transform()
    assert np.array_equal(operator(f), before)


@pytest.mark.parametrize(("n", "serial"), [(8, 4), (12, 3), (18, 5)])
def test_real_transforms_of_one_call(n, serial):
    """One each way for a pair ±g, in a call as in the transforms alone."""
    made = []

    def counting(transform):
        def count(arrays, **options):
            made.append(len(arrays) if arrays.ndim == 4 else 1)
            return transform(arrays, **options)

        return count

    fft = SimpleNamespace(rfftn=counting(np.fft.rfftn), irfftn=counting(np.fft.irfftn))
    names = ("asarray", "astype", "zeros", "matmul", "reshape", "sum", "complex128", "float64")
    xp = SimpleNamespace(fft=fft, **{name: getattr(np, name) for name in names})
    scene, rule = SCENES["2D"]
    operator = fast_operator(scene, small(rule), on_points(n, on(replace(NUMPY, xp=xp), 2**14)))
    assert len(operator.gain._batches) > 2
    operator(scene.density(operator.grid))
    pairs = 5 * 10 // 2
    assert sum(made) == operator.transforms == 2 * pairs + serial
    made.clear()
    operator.transform()
    assert sum(made) == 2 * pairs + serial


def test_an_operator_is_called_often(device):
    scene, rule = SCENES["2D"]
    operator = fast_operator(scene, small(rule), on(device))
    f = scene.density(operator.grid)
    kept = f.copy()
    first = operator(f)
    operator(2 * f)
    assert_near(operator(f), first, 1e-15)
    assert np.array_equal(f, kept)


def test_a_restitution_that_depends_on_the_impact_speed():
    scene = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1))
    with pytest.raises(ValueError, match=r"Viscoelastic\(A=0.1\): device 'gpu' takes a constant"):
        fast_operator(scene, small({"M_cir": 6}), on(NUMPY))
