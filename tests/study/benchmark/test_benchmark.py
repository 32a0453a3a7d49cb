"""The benchmark's dataset: what is there, not how fast it is."""

import numpy as np
import pytest

from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.table import csv_table, experiment_table
from granstudy.collision import collision_operator
from granstudy.datasets.netcdf import write_dataset
from granstudy.model.load_scene import load_scene
from granstudy.model.solver import Solver
from granstudy.study.benchmark.benchmark import benchmark
from granstudy.study.benchmark.timing import peak_memory_mb
from granstudy.trust.flags import Status

STUDY = """
title: speed
experiments:
  speed:
    title: speed
    run: benchmark
    scene: {name: bkw2d, restitution: 0.2}
    solver: {R: 7.0, N_rho: 4, M_cir: 4}
    sweep:
      - {N: [8], method: [direct, literal, fast, radial]}
"""


def test_every_method_is_timed_beside_literal_and_its_transforms(load, monkeypatch):
    monkeypatch.setattr("granstudy.study.benchmark.timing.LEAST_SECONDS", 0.0)
    runs = list(load().runs["speed"].values())
    ds = benchmark(runs, threads=1)
    assert list(ds["method"].values) == ["direct", "literal", "fast", "radial"]
    assert np.all(ds["seconds"] > 0) and np.all(np.isfinite(ds["peak_memory_mb"]))
    # the scene has the square's symmetry: of four angles one is evaluated
    assert list(ds["transforms"].values) == [2, 35, 11, 0]
    np.testing.assert_allclose(ds["speedup"], float(ds["seconds"][1]) / ds["seconds"])
    assert np.all(np.isnan(ds["overhead"][[0, 3]])) and np.all(ds["overhead"][1:3] > 0)


FRONT = """
title: front
experiments:
  front:
    title: front
    run: benchmark
    scene: {name: bkw2d, restitution: 0.5}
    solver: {R: 7.0}
    reference: {method: direct, N_rho: null}
    timing: {baseline: {method: literal, M_cir: 8}, single_thread: false, memory: false, radial_nodes: 40}
    sweep:
      - {N: 16, method: literal, N_rho: 8, M_cir: [4, 8]}
      - {N: 16, method: fast, rtol: [0.3, 1.0e-9]}
      - {N: [8, 20], method: radial}
    table: {quantity: error}
"""


@pytest.fixture
def front(load, monkeypatch):
    """A benchmark with a reference: its study and its dataset."""
    monkeypatch.setattr("granstudy.study.benchmark.timing.LEAST_SECONDS", 0.0)
    study = load(text=FRONT)
    return study, benchmark(list(study.runs["front"].values()), threads=2)


def test_peak_memory_is_the_evaluations_own_whatever_this_process_holds():
    ballast = np.ones(2**25)  # 256 MB
    scene = load_scene("bkw3d", restitution=0.5)
    solver = Solver(N=48, R=7.0, N_rho=2, M_sph=6, method="literal", threads=1)
    assert 10.0 < peak_memory_mb(scene, solver) < ballast.nbytes / 2**20


def test_errors_are_measured_against_the_named_reference(front):
    study, ds = front
    run = next(iter(study.runs["front"].values()))
    Q, reference = (
        operator(r.scene.density(operator.grid))
        for r in (run, run.reference)
        for operator in [collision_operator(r.scene, r.solver)]
    )
    assert run.reference.solver.N_rho is None
    expected = np.max(np.abs(Q - reference)) / np.max(np.abs(reference))
    assert float(ds["error"][0]) == pytest.approx(expected, rel=1e-9)
    # the radial runs, against one with more nodes: spectral in N
    assert ds["error"][5] < 1e-5 < 1e-3 < ds["error"][4]


def test_ratios_are_over_the_named_baseline(front):
    _, ds = front
    assert ds["baseline"].values.tolist() == [False, True, False, False, False, False]
    np.testing.assert_allclose(
        ds["speedup"][[0, 1, 5]], float(ds["seconds"][1]) / ds["seconds"][[0, 1, 5]]
    )
    assert "peak_memory_mb" not in ds


def test_parameters_that_play_no_part_are_absent(front):
    _, ds = front
    assert ds["M_cir"].values.tolist() == [4, 8, -1, -1, -1, -1]
    assert ds["rtol"].values.tolist() == [-1, -1, 0.3, 1e-9, -1, -1]
    assert float(ds["e"]) == 0.5


def test_a_tolerance_out_of_reach_is_a_failed_row(front, tmp_path):
    study, ds = front
    assert ds["status"].values.tolist() == [0, 0, 0, Status.FAILED, 0, 0]
    assert "rtol=1e-09: on N=16" in str(ds["reason"].values[3])
    assert np.isnan(ds["error"][3]) and not ds["front"][3]
    write_dataset(ds, tmp_path / "front.nc")
    table = experiment_table(study.model.experiments["front"], {}, [str(tmp_path / "front.nc")])
    assert "failed" in csv_table(table).splitlines()[4]
    assert "failed: rtol=1e-09" in markdown_table(table)


def test_a_baseline_that_is_not_one_run_is_refused(load):
    with pytest.raises(ValueError, match="experiments.front.timing.baseline: .* of 0 runs"):
        load("M_cir: 8}", "M_cir: 12}", text=FRONT)
