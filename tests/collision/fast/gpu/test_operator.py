"""The option device="gpu" from the solver to the dataset, NumPy in the GPU's place."""

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest
from comparison import assert_near, asymmetric_scene
from devices import NUMPY, strict

import granstudy as gs
from granstudy.analysis.tables.table import experiment_table
from granstudy.collision.fast.gpu import device, gain
from granstudy.collision.fast.gpu import operator as on_gpu
from granstudy.collision.fast.gpu.gain import DeviceGainSum
from granstudy.study.benchmark.benchmark import benchmark

SMALL = gs.Solver(N=12, R=7.0, N_rho=4, M_cir=6, M_sph=12, threads=1)
TOLERANT = gs.Solver(N=24, R=7.0, rtol=1e-2, threads=1)
NO_GPU = "device='gpu': needs CuPy or PyTorch with a GPU"


@pytest.fixture
def stand_in(monkeypatch):
    for module in (on_gpu, gain):
        monkeypatch.setattr(module, "find_gpu", lambda: NUMPY)


@pytest.fixture
def no_gpu(monkeypatch):
    """CuPy is not installed, PyTorch is."""

    def no_cupy():
        raise ModuleNotFoundError("No module named 'cupy'", name="cupy")

    monkeypatch.setitem(device.LIBRARIES, "CuPy", no_cupy)
    monkeypatch.setitem(device.LIBRARIES, "PyTorch", lambda: None)


@pytest.mark.parametrize(
    ("solver", "round_off"),
    [(SMALL, 1e-14), (TOLERANT, 1e-14), (replace(SMALL, precision="single"), 1e-7)],
)
def test_a_run_is_the_same_but_for_round_off(stand_in, solver, round_off):
    scene = asymmetric_scene(2, seed=1, exponent=1.0, restitution=0.37)
    time = {"t_final": 0.02, "dt": 0.01, "save_every": 1}
    cpu, other = (
        gs.simulate(scene, replace(solver, device=name), **time) for name in ("cpu", "gpu")
    )
    assert cpu["status"] == other["status"] == 0
    assert_near(other["f"].values, cpu["f"].values, round_off)
    assert not np.array_equal(other["f"].values, cpu["f"].values)
    assert other["device"] == "gpu" and "device" not in cpu.coords
    assert json.loads(other.attrs["solver"]) == json.loads(cpu.attrs["solver"]) | {"device": "gpu"}


@pytest.mark.fault("B10")
@pytest.mark.parametrize("solver", [SMALL, TOLERANT, replace(SMALL, precision="single")])
def test_a_pickled_operator_finds_the_gpu_of_its_process(stand_in, monkeypatch, solver):
    scene = asymmetric_scene(2, seed=1, exponent=1.0, restitution=0.37)
    operator = gs.collision_operator(scene, replace(solver, device="gpu"))
    f = scene.density(operator.grid)
    content = pickle.dumps(operator)
    for module in (on_gpu, gain):
        monkeypatch.setattr(module, "find_gpu", strict)
    other = pickle.loads(content)
    sum_of = getattr(other, "operator", other).gain
    assert isinstance(sum_of, DeviceGainSum) and sum_of.device.name == "strict"
    assert_near(other(f), operator(f), 1e-14 if solver.precision == "double" else 1e-6)
    if solver is SMALL:
        monkeypatch.undo()
        with pytest.raises(ValueError, match=NO_GPU):
            pickle.loads(content)


def test_auto_is_fast(stand_in):
    scene = gs.load_scene("bkw2d", restitution=0.5)
    choice = gs.choose(scene, replace(SMALL, method="auto", device="gpu"))
    assert choice.solver == replace(SMALL, device="gpu")
    operator = gs.collision_operator(scene, choice.asked)
    assert isinstance(operator.gain, DeviceGainSum)


@pytest.mark.parametrize("settings", [{}, {"rtol": 1e-2, "N": None, "R": None}])
def test_no_gpu_is_said_before_any_work(no_gpu, monkeypatch, settings):
    scene = asymmetric_scene(2)
    monkeypatch.setattr(gs.Scene, "density", None)
    solver = gs.Solver(**{"N": 12, "R": 7.0} | settings, device="gpu")
    message = f"{NO_GPU} .CuPy: cupy cannot be imported; PyTorch: finds no GPU.; take device 'cpu'"
    for start in (gs.collision_operator, gs.simulate):
        time = {"t_final": 1.0, "dt": 0.1} if start is gs.simulate else {}
        with pytest.raises(ValueError, match=message):
            start(scene, solver, **time)


def test_what_it_will_take_is_known_without_one(no_gpu):
    scene = asymmetric_scene(2)
    for solver in (SMALL, TOLERANT):
        cpu, other = (gs.plan(scene, replace(solver, device=name)) for name in ("cpu", "gpu"))
        assert other.transforms == cpu.transforms > 0
        assert "seconds are those of device 'cpu'" in repr(other)
        assert "device" not in repr(cpu)


STUDY = """
title: devices
experiments:
  speed:
    title: speed
    run: benchmark
    scene: {name: double_well2d, restitution: 0.5}
    solver: {R: 7.0, N: 12, N_rho: 4}
    reference: {method: direct}
    timing: {baseline: {N: 12, device: cpu}, memory: false, single_thread: false, rounds: 1}
    sweep:
      - {M_cir: 8, method: fast, device: [cpu, gpu]}
    table: {quantity: error}
"""


def test_a_benchmark_of_devices(stand_in, load):
    runs = load().runs["speed"]
    assert list(runs) == ["M_cir~8/method~fast/device~cpu", "M_cir~8/method~fast/device~gpu"]
    ds = benchmark(list(runs.values()), 1)
    assert ds["device"].values.tolist() == ["cpu", "gpu"]
    assert ds["baseline"].values.tolist() == [True, False]
    assert ds["error"][1] == pytest.approx(ds["error"][0].item(), rel=1e-9)
    assert (ds["fft_seconds"] > 0).all() and (ds["seconds"] > 0).all()


def test_the_growth_of_a_device_is_its_own(stand_in, load, tmp_path):
    old = "{M_cir: 8, method: fast, device: [cpu, gpu]}\n    table: {quantity: error}"
    new = "{N: [6, 12], M_cir: 8, device: [cpu, gpu]}\n    fit: {law: growth, x: N}"
    loaded = load(old, new)
    experiment, runs = loaded.model.experiments["speed"], loaded.runs["speed"]
    gs.write_dataset(benchmark(list(runs.values()), 1), tmp_path / "speed.nc")
    table = experiment_table(experiment, runs, [str(tmp_path / "speed.nc")])
    for name in ("cpu", "gpu"):
        part = table.isel(run=np.flatnonzero(table["device"] == name))
        exponent = np.log2(part["seconds"][1] / part["seconds"][0]).item()
        assert part["time_exponent"].values == pytest.approx(exponent)


def test_a_reference_does_not_inherit_the_device(load):
    runs = load("N_rho: 4}", "N_rho: 4, precision: single, device: gpu}").runs["speed"]
    for run in runs.values():
        reference = run.reference.solver
        assert (reference.method, reference.device, reference.precision) == (
            "direct",
            "cpu",
            "double",
        )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[cpu, gpu]", "[cpu, gppu]", "device~gppu: unknown device 'gppu' .did you mean 'gpu'"),
        ("method: fast", "method: literal", "only methods 'auto' and 'fast' take it"),
        (
            "restitution: 0.5",
            "restitution: {viscoelastic: 0.1}",
            "device~gpu: restitution=Viscoelastic.A=0.1.: device 'gpu' takes a constant",
        ),
    ],
)
def test_mistakes_in_a_study(load, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(old, new)


def test_runs_of_both_devices_in_one_array(stand_in, tmp_path):
    scene = gs.load_scene("bkw2d", restitution=0.5)
    for name in ("cpu", "gpu"):
        solver = replace(SMALL, device=name)
        ds = gs.simulate(scene, solver, t_final=0.01, dt=0.01)
        gs.write_dataset(ds, tmp_path / f"{name}.nc")
    runs = gs.unstack_runs(gs.open_runs(tmp_path), ("device",))
    assert runs["device"].values.tolist() == ["cpu", "gpu"]
    assert_near(*runs["temperature"].values, 1e-14)
    assert "device" not in gs.open_runs([tmp_path / "cpu.nc"]).coords


class TestGPU:
    """What only a GPU can show; its sums are tested beside the other devices'."""

    def test_an_operator_asked_for_is_there(self):
        try:
            found = device.find_gpu()
        except ValueError:
            pytest.skip("no GPU with CuPy or PyTorch")
        scene = asymmetric_scene(3, seed=1, exponent=1.0, restitution=0.37)
        operator = gs.collision_operator(scene, replace(SMALL, device="gpu"))
        assert operator.gain.device.name == found.name and found.memory > 0
        f = scene.density(operator.grid)
        assert_near(operator(f), gs.collision_operator(scene, SMALL)(f), 1e-13)
