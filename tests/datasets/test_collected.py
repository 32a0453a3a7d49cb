"""Runs gathered in one file: what is read again, and that nothing is lost by it."""

import os

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.datasets import collected
from granstudy.datasets.collected import gather, read_collected
from granstudy.support.errors import DamagedFileError


@pytest.fixture
def files(tmp_path):
    """Files of runs of several kinds by their keys."""
    solver = gs.Solver(N=8, R=7.8, N_rho=4, M_cir=4, threads=1)
    found = {}
    for key, e, dt, t_final in (
        ("a", 0.2, 0.1, 0.2),
        ("b", 0.8, 0.1, 0.1),
        ("c", gs.Viscoelastic(0.1), 0.1, 0.2),
        ("d", 0.5, 0.05, 0.2),
    ):
        ds = gs.simulate(gs.load_scene("bkw2d", restitution=e), solver, t_final=t_final, dt=dt)
        found[key] = tmp_path / f"{key}.nc"
        gs.write_dataset(ds.assign_attrs(run_key=key), found[key])
    return found


@pytest.fixture
def read(monkeypatch):
    """Names of the files read so far."""
    names, heads = [], collected.heads

    def spied(files):
        files = list(files)
        names.extend(os.path.basename(file) for file in files)
        return heads(files)

    monkeypatch.setattr(collected, "heads", spied)
    return names


def taken(files, keys):
    return {key: files[key] for key in keys}


def test_gathered_runs_are_those_of_open_runs(files):
    runs = gather(files)
    xr.testing.assert_identical(runs.reset_coords("run_key"), gs.open_runs(files.values()))
    assert runs["run_key"].values.tolist() == list(files)


def test_only_what_is_new_or_changed_is_read(files, read, tmp_path):
    cache = tmp_path / "all/runs.nc"
    gather(taken(files, "ab"), cache)
    assert read == ["a.nc", "b.nc"]
    gather(taken(files, "ab"), cache)
    assert read == ["a.nc", "b.nc"]
    runs = gather(taken(files, "dcba"), cache)
    assert read[2:] == ["d.nc", "c.nc"]
    assert runs["run_key"].values.tolist() == ["d", "c", "b", "a"]
    changed = gs.read_dataset(files["b"])
    changed["temperature"][:] = 7.0
    gs.write_dataset(changed, files["b"])
    runs = gather(files, cache)
    assert read[4:] == ["b.nc"]
    assert (runs["temperature"][1, :2] == 7.0).all()
    again = gather(files, cache)
    assert len(read) == 5
    fresh = gather(files)
    for found in (runs, again):
        xr.testing.assert_equal(found, fresh[[*found.data_vars]])
        assert found.sizes == fresh.sizes
    gather(taken(files, "a"), cache)
    assert read_collected(cache).sizes["run"] == 1


def test_a_collected_file_comes_back_the_same(files, tmp_path):
    first = gather(files, tmp_path / "runs.nc")
    second = gather(files, tmp_path / "runs.nc")
    xr.testing.assert_equal(second, first)
    for name, variable in first.variables.items():
        assert (
            str(second[name].attrs) == str(variable.attrs) and second[name].dtype == variable.dtype
        )
    xr.testing.assert_equal(gs.final_values(second), gs.final_values(first))


@pytest.mark.parametrize("how", ["cut", "foreign", "other"])
def test_a_damaged_or_foreign_collected_file_is_made_anew(files, read, tmp_path, how):
    cache = tmp_path / "runs.nc"
    first = gather(files, cache)
    if how == "cut":
        cache.write_bytes(cache.read_bytes()[:-9])
    elif how == "foreign":
        cache.write_text("no dataset")
    else:
        gs.write_dataset(xr.Dataset({"a": 1}), cache)
    xr.testing.assert_identical(gather(files, cache), first)
    assert len(read) == 8
    assert read_collected(cache)["run_key"].values.tolist() == list(files)


def test_what_is_wrong_with_files_is_said(files, tmp_path):
    with pytest.raises(ValueError, match=r"other keys: .*a.nc \(of a, not x\)"):
        gather({"x": files["a"]})
    with pytest.raises(FileNotFoundError, match="no runs to gather"):
        gather({})
    with pytest.raises(FileNotFoundError, match=r"z\.nc"):
        gather({"z": tmp_path / "z.nc"})
    for key in "bd":
        files[key].write_bytes(files[key].read_bytes()[:3000])
    with pytest.raises(DamagedFileError, match="2 of 4 files are damaged"):
        gather(files, tmp_path / "runs.nc")
    assert not (tmp_path / "runs.nc").exists()
    assert np.isfinite(gather(taken(files, "ac"))["temperature"]).all()
