"""Which files of a folder are the study's runs."""

import json
import warnings

import pytest
import xarray as xr

import granstudy as gs


@pytest.fixture
def runs(tmp_path):
    """A study's folder of runs: four listed, one of them missing, one of another key, and two strangers."""
    folder = tmp_path / "results/mine/runs"
    listed = {
        "cooling/e~0.2": "k2",
        "cooling/e~0.5": "k5",
        "cooling/e~0.8": "k8",
        "heated/e~0.2": "h2",
    }
    files = {"cooling/e~0.2": "k2", "cooling/e~0.5": "old", "heated/e~0.2": "h2"}
    strangers = {"cooling/e~0.9": "k9", "gone/e~0.2": "g2"}
    left_out = {"cooling/reference/e~1.0": "r", ".unfinished/cooling/x": "x"}
    for path, key in (files | strangers | left_out).items():
        gs.write_dataset(
            xr.Dataset({"T": 1.0}, {"e": float(len(path))}, {"run_key": key}), folder / f"{path}.nc"
        )
    (folder / "study.json").write_text(json.dumps({"study": "mine", "runs": listed}))
    return folder


def keys(where):
    return sorted(gs.open_runs(where)["run_key"].values.tolist())


@pytest.mark.fault("A4")
def test_files_that_the_study_does_not_have_are_left_out_with_one_warning(runs):
    with pytest.warns(UserWarning) as caught:
        assert keys(runs) == ["h2", "k2"]
    (told,) = [str(one.message) for one in caught]
    assert "2 files are not of the study" in told and "`granstudy prune`" in told
    assert "cooling/e~0.9.nc" in told and "gone/e~0.2.nc" in told
    assert "1 file is of another run than the study has" in told and "cooling/e~0.5.nc" in told
    assert "1 file is not there" in told and "cooling/e~0.8.nc" in told


def test_the_list_is_found_above_and_below(runs, monkeypatch):
    with pytest.warns(
        UserWarning, match=r"1 file is not of the study.*1 file is not there"
    ) as caught:
        assert keys(runs / "cooling") == ["k2"]
    assert "gone" not in str(caught[0].message)
    with pytest.warns(UserWarning, match="2 files are not of the study"):
        assert keys(runs.parents[1]) == ["h2", "k2"]
    monkeypatch.chdir(runs / "cooling")
    with pytest.warns(UserWarning, match="1 file is not of the study"):
        assert keys(".") == ["k2"]


def test_a_folder_that_holds_what_is_listed_or_has_no_list_is_silent(runs):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert keys(runs / "heated") == ["h2"]
        assert keys((runs / "cooling").glob("*.nc")) == ["k2", "k9", "old"]
        (runs / "study.json").write_text("[]")
        assert keys(runs) == ["g2", "h2", "k2", "k9", "old"]
        (runs / "study.json").unlink()
        assert keys(runs) == ["g2", "h2", "k2", "k9", "old"]


def test_many_strangers_are_counted_and_the_first_named(runs):
    for i in range(20):
        gs.write_dataset(xr.Dataset({"T": 1.0}, {"e": 0.5}), runs / f"gone/n~{i:02}.nc")
    with pytest.warns(UserWarning, match=r"22 files are not .*gone/n~02.nc, \.\.\.\)") as caught:
        gs.open_runs(runs)
    assert "n~03" not in str(caught[0].message)


def test_a_study_with_nothing_of_its_own_is_an_error(runs):
    with pytest.raises(FileNotFoundError, match="no runs"):
        gs.open_runs(runs / "gone")
