"""The radial method in a study: runs, their cost, and what a study refuses."""

import json

import pytest

import granstudy as gs
from granstudy.runs.estimates import estimate_run
from granstudy.runs.execute import execute

STUDY = """
title: cooling
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {method: radial, N: 16, R: 7.0}
    time: {t_final: 0.5, dt: 0.05, save_every: 10}
    sweep:
      - {e: [0.2, 0.8]}
"""


def test_runs_are_written_and_opened_together(load, tmp_path):
    for name, run in load().runs["cooling"].items():
        gs.write_dataset(execute(run.computation, threads=1), tmp_path / "runs" / f"{name}.nc")
    runs = gs.unstack_runs(gs.open_runs(tmp_path / "runs", densities=True))
    assert runs["f"].dims == ("e", "snapshot", "r")
    assert runs["f"].sizes == {"e": 2, "snapshot": 2, "r": 16}
    T = runs["temperature"].isel(time=-1)
    assert float(T.sel(e=0.2)) < float(T.sel(e=0.8)) < 1.0
    final = gs.final_values(tmp_path / "runs")
    assert "r" not in final.dims and float(abs(final["density_drift"]).max()) < 1e-13


def test_the_cost_is_that_of_a_small_run(load):
    cost = estimate_run(load().run("cooling", "e~0.2").computation).cost
    assert 0 < cost.seconds < 1 and cost.memory_mb < 500


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name: maxwellian3d", "name: double_well3d", "e~0.2: initial=DoubleWell3D.*isotropic"),
        ("1.0, ", "1.0, velocity: [0.5, 0.0, 0.0], ", "e~0.2: initial=Maxwellian.*isotropic"),
        ("dt: 0.05", "dt: 0.05, time_rtol: 1.0e-5", "dt=0.05, time_rtol=1e-05: give one"),
        ("dt: 0.05", "dt: 0.05, frame: moving", "unknown frame 'moving'"),
        ("dt: 0.05", "dt: 0.05, conserve: mass-spin", "unknown invariant in conserve .spin."),
        ("N: 16", "N: 3", "N=3: must be an integer of at least 4, the number of radial nodes"),
        (
            "run: evolution\n",
            "run: collision\n    reference: {method: direct}\n",
            "time: evolution runs need it",
        ),
    ],
)
def test_mistakes(load, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(old, new)


def test_a_collision_run_and_its_reference_share_their_nodes(load):
    lines = STUDY.replace("run: evolution", "run: collision").splitlines()
    lines = [line for line in lines if "time:" not in line]
    lines.insert(5, "    reference: {method: direct}")
    with pytest.raises(ValueError, match="method 'radial': has other velocity nodes than its ref"):
        load(text="\n".join(lines))


RESCALED = """time_rtol: 1.0e-5, frame: rescaled, conserve: mass-momentum,
           times: {first: 1.0, last: 100.0, per_decade: 5}"""


def test_a_long_rescaled_run_of_adaptive_steps(load):
    study = load("t_final: 0.5, dt: 0.05", f"t_final: 100.0, {RESCALED}")
    run = study.run("cooling", "e~0.2")
    ds = execute(run.computation, threads=1)
    assert ds.sizes["time"] == 12 and float(ds["time"][1]) == 1.0
    assert str(ds["frame"].values) == "rescaled" and str(ds["conserve"].values) == "mass-momentum"
    counts = json.loads(ds.attrs["steps"])
    expected = estimate_run(run.computation).evaluations
    assert counts["evaluations"] / 4 < expected < 4 * counts["evaluations"]


def test_frames_schemes_and_tolerances_are_swept(load, tmp_path):
    sweep = """{e: [0.8], frame: [fixed, rescaled], scheme: [dopri54, exponential],
         conserve: [none, mass], time_rtol: [1.0e-4]}"""
    study = load(STUDY[STUDY.index(", dt:") :], f"}}\n    sweep:\n      - {sweep}\n")
    runs = study.runs["cooling"]
    assert "e~0.8/frame~rescaled/scheme~exponential/conserve~mass/time_rtol~0.0001" in runs
    for name, run in runs.items():
        gs.write_dataset(execute(run.computation, threads=1), tmp_path / "runs" / f"{name}.nc")
    T = gs.unstack_runs(gs.final_values(tmp_path / "runs"))["temperature"]
    assert T.sizes == {"frame": 2, "scheme": 2, "conserve": 2}
    assert float(T.max() - T.min()) < 1e-3


def test_a_study_without_new_fields_keeps_its_parameters(load):
    time = json.loads(load().run("cooling", "e~0.2").computation.parameters)["time"]
    asked = {key: value for key, value in time.items() if value not in (None, [])}
    assert asked == {
        "t_final": 0.5,
        "dt": 0.05,
        "save_every": 10,
        "frame": "fixed",
        "scheme": "rk3",
    }
