"""Runs that are not trusted warn once for a dataset, with the remedy; trusted runs do not."""

import warnings

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.trust.notice import notice

REMEDY = "take a larger N and R"


def short(N, **words):
    scene = gs.load_scene("bkw2d", **words)
    how = {"t_final": 0.1, "dt": 0.05, "progress": False}
    return scene, gs.Solver(N=N, R=8.0, method="radial"), how


def test_a_run_warns_with_its_remedy():
    scene, solver, how = short(6)
    with pytest.warns(gs.NotTrustedWarning, match=f"the run is untrusted: .*{REMEDY}") as caught:
        gs.simulate(scene, solver, **how)
    assert len(caught) == 1 and caught[0].filename == __file__
    assert issubclass(gs.NotTrustedWarning, UserWarning)


def test_a_trusted_run_says_nothing():
    scene, solver, how = short(32)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gs.simulate(scene, solver, **how)


def test_a_sweep_warns_once_and_names_the_worst(tmp_path):
    scene, _, how = short(8)
    over = {"N": [32, 6]}
    with pytest.warns(gs.NotTrustedWarning) as caught:
        gs.sweep(
            scene, over=over, R=8.0, method="radial", results=tmp_path, workers=1,
            **how | {"progress": False},
        )  # fmt: skip
    (warning,) = caught
    assert str(warning.message).startswith("1 untrusted of 2 runs")
    assert "- N=6: untrusted; " in str(warning.message) and REMEDY in str(warning.message)
    assert warning.filename == __file__


def test_a_study_warns_of_its_dataset(tmp_path):
    experiment = {
        "title": "a", "run": "evolution", "scene": {"name": "bkw2d", "diffusion": 0.0},
        "solver": {"method": "radial", "R": 8.0}, "time": {"t_final": 0.1, "dt": 0.05},
        "sweep": [{"e": [0.5], "N": [6, 32]}],
    }  # fmt: skip
    study = gs.open_study(
        {"title": "s", "experiments": {"a": experiment}}, name="s", results=tmp_path
    )
    study.compute(workers=1, progress=False)
    with pytest.warns(gs.NotTrustedWarning, match="1 untrusted of 2 runs") as caught:
        study.dataset("a")
    assert "N=6" in str(caught[0].message) and caught[0].filename == __file__


def test_counts_and_names():
    runs = xr.Dataset(
        {
            "trust": (("e", "N"), np.array([[0, 1, 2], [-1, 1, 2]], np.int8)),
            "trust_reasons": (("e", "N"), [["x\ny", "z", ""], ["", "w", ""]]),
        },
        {"e": [0.5, 0.7], "N": [8, 16, 32]},
    )
    told = notice(runs).splitlines()
    assert told[0] == "1 untrusted and 2 marginal of 5 runs (ds.granular.trusted says which):"
    assert told[1] == "- e=0.5, N=8: untrusted; x; y"
    assert told[2] == "- e=0.5, N=16: marginal; z"
    assert len(told) == 4
    assert notice(runs.isel(N=[2])) == "" and notice(xr.Dataset()) == ""
