"""An accuracy in a study file and in a sweep: swept, keyed, computed, kept."""

import json

import numpy as np
import pytest
from studies import computed, load_text, replaced

import granstudy as gs
from granstudy.runs.estimates import estimate_run
from granstudy.runs.run_key import code_of_run, run_key
from granstudy.study.checks import check_run

STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw2d, exponent: 1.0, diffusion: 0.0}
    accuracy: {temperature: 1.0e-3, a2: 5.0e-3}
    time: {t_final: 1.0, times: [0.5]}
    sweep:
      - e: [0.5, 0.9]
  finer:
    title: accuracies
    run: evolution
    scene: {name: bkw2d, e: 0.5, exponent: 1.0, diffusion: 0.0}
    time: {t_final: 1.0, times: [0.5]}
    sweep:
      - accuracy: [1.0e-2, 1.0e-3]
  states:
    title: states
    run: state
    state: cooling
    scene: {name: maxwellian2d, exponent: 1.0, diffusion: 0.0}
    accuracy: 1.0e-3
    sweep:
      - e: [0.5]
"""


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def study(old="", new=""):
    return load_text(".", replaced(STUDY, old, new))


def test_runs_of_a_study_ask_for_an_accuracy():
    runs = study().runs["cooling"]
    for run in runs.values():
        check_run(run)
        assert (run.solver.accuracy, run.solver.a2_accuracy) == (1e-3, 5e-3)
        assert estimate_run(run.computation).cost.seconds > 0.0
    files = computed(runs, "runs/cooling")
    for file in files:
        ds = gs.read_dataset(file)
        assert json.loads(ds.attrs["asked"]) == {"temperature": 1e-3, "a2": 5e-3}
        assert ds["time"].values.tolist() == [0.0, 0.5, 1.0]
        assert ds.attrs["run_key"]


def test_accuracies_are_swept_like_any_parameter():
    runs = study().runs["finer"]
    assert list(runs) == ["accuracy~0.001", "accuracy~0.01"] or len(runs) == 2
    keys = {run_key(run.computation) for run in runs.values()}
    assert len(keys) == 2
    asked = sorted(run.solver.accuracy for run in runs.values())
    assert asked == [1e-3, 1e-2]


def test_states_of_a_study_ask_for_an_accuracy():
    (run,) = study().runs["states"].values()
    check_run(run)
    (file,) = computed({run.path: run}, "runs/states")
    ds = gs.read_dataset(file)
    assert float(ds["a2_error"]) <= 1e-2


def test_keys_follow_the_code_that_chooses_and_both_methods():
    runs = study().runs["cooling"]
    code = code_of_run(next(iter(runs.values())).computation)
    assert "granstudy.accuracy.evolve" in code
    assert any("radial" in module for module in code)
    assert any("adaptive" in module for module in code)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("accuracy: {temperature: 1.0e-3, a2: 5.0e-3}", "accuracy: {}", "give one"),
        ("accuracy: {temperature: 1.0e-3, a2: 5.0e-3}", "accuracy: 2.0", "between"),
        ("times: [0.5]}\n    sweep:\n      - e", "dt: 0.1}\n    sweep:\n      - e", "accuracy"),
    ],
)
def test_what_an_accuracy_cannot_be_is_said(old, new, said):
    with pytest.raises(ValueError, match=said):
        for run in study(old, new).runs["cooling"].values():
            check_run(run)


def test_a_sweep_in_python_takes_accuracies():
    over = {"e": [0.5, 0.9], "accuracy": [1e-2, 1e-3]}
    words = {"exponent": 1.0, "t_final": 1.0, "times": [0.5]}
    ds = gs.sweep("bkw2d", over=over, **words, progress=False)
    assert ds["temperature"].sizes["e"] == 2
    assert ds["temperature"].sizes["accuracy"] == 2
    assert np.isfinite(ds["temperature"]).all()
