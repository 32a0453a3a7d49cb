"""Many runs opened as one dataset: what is labelled, what is a hole, what does not fit together."""

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.support.errors import DamagedFileError


def write_run(folder, name, *, e=0.5, N=8, variant="full", dt=0.1, t_final=0.2, **more):
    scene = gs.load_scene("bkw2d", restitution=e)
    solver = gs.Solver(N=N, R=7.8, N_rho=6, M_cir=6, variant=variant, threads=1)
    ds = gs.simulate(scene, solver, t_final=t_final, dt=dt, **more)
    gs.write_dataset(ds, folder / f"{name}.nc")
    return ds


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Five of the six runs over two e, two N and two variants at one N."""
    path = tmp_path_factory.mktemp("runs")
    for e, N, variant in (
        (0.2, 8, "full"),
        (0.2, 16, "full"),
        (0.2, 16, "separate"),
        (0.8, 8, "full"),
        (0.8, 16, "separate"),
    ):
        write_run(path, f"e~{e}/N~{N}/variant~{variant}", e=e, N=N, variant=variant)
    write_run(path, "reference/N~8", e=1.0)
    return path


def test_parameters_run_along_run_and_values_are_in_memory(folder):
    runs = gs.open_runs(folder)
    assert runs.sizes["run"] == 5  # the reference is left out
    assert set(zip(runs["e"].values, runs["N"].values, runs["variant"].values, strict=True)) == {
        (0.2, 8, "full"),
        (0.2, 16, "full"),
        (0.2, 16, "separate"),
        (0.8, 8, "full"),
        (0.8, 16, "separate"),
    }
    assert runs["temperature"].chunks is None
    assert runs["temperature"].dims == ("run", "time")
    assert runs["temperature"].attrs["long_name"] and runs["time"].attrs["long_name"] == "time t"
    assert runs["outputs"].values.tolist() == [3] * 5
    assert "f" not in runs and not {"vx", "snapshot"} & set(runs.dims)


def test_densities_stay_on_disk_until_they_are_used(tmp_path):
    kept = [write_run(tmp_path, f"e~{e}", e=e, save_every=1) for e in (0.2, 0.8)]
    runs = gs.open_runs(tmp_path, densities=True)
    assert runs["f"].chunks is not None and runs["f"].dims == ("run", "snapshot", "vx", "vy")
    np.testing.assert_array_equal(runs["f"], [ds["f"] for ds in kept])
    np.testing.assert_array_equal(runs["vx"], kept[0]["vx"])
    assert runs["f"].attrs == kept[0]["f"].attrs
    short = write_run(tmp_path, "e~0.5", e=0.5, t_final=0.1, save_every=1)
    runs = gs.open_runs([tmp_path / "e~0.5.nc", tmp_path / "e~0.2.nc"], densities=True)
    assert runs["f"].sizes["snapshot"] == 3
    np.testing.assert_array_equal(runs["f"][0, :2], short["f"])
    assert np.isnan(runs["f"][0, 2]).all()
    write_run(tmp_path, "other", e=0.5, dt=0.05, save_every=1)
    runs = gs.open_runs([tmp_path / "other.nc", tmp_path / "e~0.2.nc"], densities=True)
    assert runs["f"].dims == ("run", "kept", "vx", "vy")
    np.testing.assert_allclose(runs["snapshot"][1, :3], [0.0, 0.1, 0.2])
    assert np.isnan(runs["snapshot"][1, 3:]).all()


@pytest.mark.parametrize("how", ["folder", "glob", "files"])
def test_runs_are_found(folder, how):
    where = {
        "folder": folder,
        "glob": str(folder / "e~*" / "**" / "*.nc"),
        "files": folder.glob("e~*/*/*.nc"),
    }[how]
    assert gs.open_runs(where).sizes["run"] == 5


def test_no_runs_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError, match="no runs there"):
        gs.open_runs(tmp_path)


def test_final_values_are_the_last_ones(folder):
    final = gs.final_values(folder)
    runs = gs.open_runs(folder)
    np.testing.assert_array_equal(final["temperature"], runs["temperature"].isel(time=-1))
    density = runs["density"]
    drift = density.isel(time=-1) / density.isel(time=0) - 1.0
    np.testing.assert_array_equal(final["density_drift"], drift)


def test_final_values_come_from_runs_that_are_open(folder, monkeypatch):
    runs, final = gs.open_runs(folder), gs.final_values(folder)
    monkeypatch.setattr("granstudy.datasets.netcdf.read_head", None)
    xr.testing.assert_identical(gs.final_values(runs), final)


def test_runs_of_different_steps_have_times_of_their_own(tmp_path):
    fine = write_run(tmp_path, "dt~0.05", dt=0.05)
    coarse = write_run(tmp_path, "dt~0.1", dt=0.1)
    runs = gs.open_runs(tmp_path)
    assert runs["time"].dims == ("run", "output") == runs["temperature"].dims
    assert runs["time"].attrs == fine["time"].attrs
    for i, ds in enumerate((fine, coarse)):
        n = ds.sizes["time"]
        assert runs["outputs"][i] == n
        np.testing.assert_array_equal(runs["time"][i, :n], ds["time"])
        np.testing.assert_array_equal(runs["temperature"][i, :n], ds["temperature"])
        assert np.isnan(runs["temperature"][i, n:]).all() and np.isnan(runs["time"][i, n:]).all()
    array = gs.unstack_runs(gs.final_values(runs), ["dt"])
    assert array["dt"].values.tolist() == [0.05, 0.1]
    np.testing.assert_allclose(array["time"], 0.2)
    assert gs.unstack_runs(runs, ["dt"])["temperature"].dims == ("dt", "output")


@pytest.mark.fault("C5")
def test_mixed_runs_open_together(tmp_path):
    law = gs.Viscoelastic(0.1)
    write_run(tmp_path, "a", e=0.5)
    write_run(tmp_path, "b", e=law)
    steps = gs.simulate(
        gs.load_scene("bkw2d", restitution=0.5),
        gs.Solver(N=16, R=7.8, method="radial", threads=1),
        t_final=0.2,
        times=[0.1, 0.2],
        time_rtol=1e-4,
    )
    gs.write_dataset(steps, tmp_path / "c.nc")
    bulk = xr.Dataset(
        {"temperature": ("time", [1.0, 0.5]), "bulk": 3, "own": ("layer", [1, 2])},
        {"time": [0.0, 0.1], "e": 0.5, "kind": "mine", "flag": True, "N": 8, "count": 4},
    )
    gs.write_dataset(bulk, tmp_path / "d.nc")
    runs = gs.open_runs(tmp_path)
    np.testing.assert_array_equal(runs["e"], [0.5, np.nan, 0.5, 0.5])
    assert runs["restitution"].values.tolist() == ["", "viscoelastic", "", ""]
    np.testing.assert_array_equal(runs["dt"], [0.1, 0.1, np.nan, np.nan])
    np.testing.assert_array_equal(runs["time_rtol"], [-1.0, -1.0, 1e-4, -1.0])
    assert runs["kind"].values.tolist() == ["", "", "", "mine"]
    np.testing.assert_array_equal(runs["count"], [np.nan] * 3 + [4.0])
    np.testing.assert_array_equal(runs["flag"], [np.nan] * 3 + [1.0])
    np.testing.assert_array_equal(runs["bulk"], [np.nan] * 3 + [3.0])
    np.testing.assert_array_equal(runs["own"], [[np.nan] * 2] * 3 + [[1.0, 2.0]])
    assert (
        runs["status"].values.tolist()
        == [0, 0, 0, -1]
        == runs["trust"].where(runs["trust"] < 0, 0).values.tolist()
    )
    assert runs["N"].dtype.kind == "i" and "outputs" in runs
    assert runs["time"].dims == ("time",)
    np.testing.assert_array_equal(runs["temperature"][3], [1.0, 0.5, np.nan])
    final = gs.final_values(runs)
    assert final["temperature"][3] == 0.5 and final["time"][3] == 0.1
    assert np.isnan(final["density_drift"][3]) and np.isfinite(final["density_drift"][:3]).all()


@pytest.mark.fault("C5")
def test_gases_of_two_and_three_dimensions_open_together(tmp_path):
    solver = gs.Solver(N=8, R=7.0, method="radial", threads=1)
    for d in (2, 3):
        ds = gs.simulate(
            gs.load_scene(f"maxwellian{d}d", restitution=0.5), solver, t_final=0.1, dt=0.1
        )
        gs.write_dataset(ds, tmp_path / f"{d}.nc")
    runs = gs.open_runs(tmp_path)
    assert runs["component"].values.tolist() == ["x", "y", "z"]
    assert np.isnan(runs["velocity"][0, :, 2]).all() and np.isfinite(runs["velocity"][1]).all()


def test_states_and_evolutions_are_opened_one_after_the_other(tmp_path):
    for name, dims in (("a", ()), ("b", ("time",))):
        gs.write_dataset(
            xr.Dataset({"a2": (dims, np.ones(2 if dims else ()))}), tmp_path / f"{name}.nc"
        )
    with pytest.raises(
        ValueError, match=r"a2: has the axes \(\) in some runs and \('time',\) in others"
    ):
        gs.open_runs(tmp_path)


def test_axes_that_differ_are_coordinates_of_each_run(tmp_path):
    for i, speeds in enumerate(([1.0, 2.0], [1.5, 2.5, 3.5])):
        ds = xr.Dataset({"tail": ("speed", np.array(speeds) ** 2)}, {"speed": speeds, "e": i / 2})
        gs.write_dataset(ds, tmp_path / f"{i}.nc")
    runs = gs.open_runs(tmp_path)
    assert runs["tail"].dims == ("run", "speed_index") == runs["speed"].dims
    np.testing.assert_array_equal(runs["speed"], [[1.0, 2.0, np.nan], [1.5, 2.5, 3.5]])
    np.testing.assert_array_equal(runs["tail"], runs["speed"] ** 2)


def test_rows_of_growing_length_keep_their_values(tmp_path):
    lengths = (1, 2, 5, 3, 20, 0)
    for i, n in enumerate(lengths):
        ds = xr.Dataset({"T": ("time", np.full(n, float(i))), "density": ("time", np.ones(n))})
        gs.write_dataset(ds.assign_coords(time=np.arange(n) / 2), tmp_path / f"{i}.nc")
    runs = gs.open_runs(tmp_path)
    assert runs["T"].shape == (6, 20) and runs["outputs"].values.tolist() == list(lengths)
    for i, n in enumerate(lengths):
        assert (runs["T"][i, :n] == i).all() and np.isnan(runs["T"][i, n:]).all()
    final = gs.final_values(runs)
    np.testing.assert_array_equal(final["T"], [0, 1, 2, 3, 4, np.nan])
    np.testing.assert_array_equal(final["time"], [0, 0.5, 2, 1, 9.5, np.nan])
    none = gs.final_values([tmp_path / "5.nc"])
    assert np.isnan(none["T"]).all() and np.isnan(none["density_drift"]).all()


def test_one_error_names_all_damaged_files(folder, tmp_path):
    files = sorted(folder.glob("e~*/*/*.nc"))
    copies = [tmp_path / f"{i}.nc" for i in range(len(files))]
    for i, (file, copy) in enumerate(zip(files, copies, strict=True)):
        copy.write_bytes(file.read_bytes()[: 2000 if i in (1, 3) else None])
    with pytest.raises(DamagedFileError, match=r"2 of 5 files are damaged:\n.*1.nc: .*\n.*3.nc: "):
        gs.open_runs(tmp_path)


def test_a_run_that_ended_early_says_so(tmp_path):
    ok = write_run(tmp_path, "ok", e=1.0, dt=0.5, t_final=3.0)
    early = write_run(tmp_path, "early", e=0.1, dt=0.5, t_final=3.0)
    assert (ok["status"], early["status"]) == (0, 2), "these scenes no longer end as the test needs"
    runs = gs.open_runs([tmp_path / "ok.nc", tmp_path / "early.nc"])
    assert runs.sizes["time"] == ok.sizes["time"] > early.sizes["time"]
    assert np.isnan(runs["temperature"][1].values[early.sizes["time"] :]).all()
    assert np.isfinite(runs["temperature"][0].values).all()
    assert runs["status"].values.tolist() == [0, 2]
    assert runs["reason"].values[1] == early["status"].attrs["reason"] != ""
    final = gs.final_values([tmp_path / "early.nc"])
    assert final["time"].item() == early["time"].values[-1] < 3.0
    assert final["temperature"].values[0] == early["temperature"].values[-1]


def test_densities_on_different_grids_do_not_go_into_one_array(tmp_path):
    for N in (8, 16):
        write_run(tmp_path, f"N~{N}", N=N, save_every=2)
    with pytest.raises(ValueError, match=r"velocity grids \[\(8, 7.8\), \(16, 7.8\)\]"):
        gs.open_runs(tmp_path, densities=True)
    assert gs.final_values(tmp_path)["temperature"].sizes == {"run": 2}
    moments = gs.open_runs(tmp_path)
    assert moments["temperature"].sizes == {"run": 2, "time": 3} and "f" not in moments
    assert gs.open_runs([tmp_path / "N~8.nc"], densities=True)["f"].dims == (
        "run",
        "snapshot",
        "vx",
        "vy",
    )


def test_sphere_rules_without_angles_have_minus_one(tmp_path):
    scene = gs.load_scene("bkw3d", restitution=0.5)
    for rule, M_sph in (("gauss-theta-phi", (2, 3)), ("design", 6)):
        solver = gs.Solver(N=4, R=7.0, N_rho=2, M_sph=M_sph, sphere_rule=rule, threads=1)
        ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1)
        gs.write_dataset(ds, tmp_path / f"{rule}.nc")
    runs = gs.open_runs([tmp_path / "gauss-theta-phi.nc", tmp_path / "design.nc"])
    assert runs["N_theta"].values.tolist() == [2, -1]
    assert runs["N_phi"].values.tolist() == [3, -1]
    assert runs["M_sph"].values.tolist() == [6, 6]
