"""Many runs opened as one dataset: what is labelled, what is a hole, what does not fit together."""

import numpy as np
import pytest
import xarray as xr

import granstudy as gs


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


def test_parameters_run_along_run_and_values_stay_on_disk(folder):
    runs = gs.open_runs(folder)
    assert runs.sizes["run"] == 5  # the reference is left out
    assert set(zip(runs["e"].values, runs["N"].values, runs["variant"].values, strict=True)) == {
        (0.2, 8, "full"),
        (0.2, 16, "full"),
        (0.2, 16, "separate"),
        (0.8, 8, "full"),
        (0.8, 16, "separate"),
    }
    assert runs["temperature"].chunks is not None
    assert runs["temperature"].dims == ("run", "time")
    assert runs["temperature"].attrs["long_name"]


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


def test_unstacked_runs_are_the_runs_and_holes_say_missing(folder):
    array = gs.unstack_runs(gs.open_runs(folder))
    assert array["temperature"].dims == ("e", "N", "variant", "time")
    assert array["R"].item() == 7.8
    for path in folder.glob("e~*/*/*.nc"):
        with xr.open_dataset(path, engine="netcdf4") as run:
            place = {name: run[name].item() for name in ("e", "N", "variant")}
            found = array["temperature"].sel(place)
            np.testing.assert_array_equal(found, run["temperature"])
            assert array["status"].sel(place) == 0
    assert (array["status"] == -1).sum() == 3
    hole = {"e": 0.8, "N": 16, "variant": "full"}
    assert array["status"].sel(hole) == -1
    meanings = array["status"].attrs["flag_meanings"].split()
    assert meanings[array["status"].attrs["flag_values"].tolist().index(-1)] == "missing"


def test_one_parameter_becomes_a_plain_dimension(folder):
    array = gs.unstack_runs(gs.open_runs(folder / "e~0.8"), ["N"])
    assert array["N"].values.tolist() == [8, 16]
    assert array["temperature"].dims == ("N", "time")


def test_runs_that_share_a_place_are_refused(folder):
    runs = gs.open_runs(folder)
    with pytest.raises(ValueError, match=r"several runs share a place.*\['variant'\]"):
        gs.unstack_runs(runs, ("e", "N"))
    with pytest.raises(ValueError, match="did you mean 'variant'"):
        gs.unstack_runs(runs, ("e", "N", "varient"))


def test_final_values_are_the_last_ones(folder):
    final = gs.final_values(folder)
    runs = gs.open_runs(folder)
    np.testing.assert_array_equal(final["temperature"], runs["temperature"].isel(time=-1))
    density = runs["density"]
    drift = density.isel(time=-1) / density.isel(time=0) - 1.0
    np.testing.assert_array_equal(final["density_drift"], drift)


def test_runs_of_different_steps_have_final_values_only(tmp_path):
    write_run(tmp_path, "dt~0.1", dt=0.1)
    write_run(tmp_path, "dt~0.05", dt=0.05)
    with pytest.raises(ValueError, match=r"dt: .*\[0.05, 0.1\].*final_values"):
        gs.open_runs(tmp_path)
    array = gs.unstack_runs(gs.final_values(tmp_path), ["dt"])
    assert array["dt"].values.tolist() == [0.05, 0.1]
    np.testing.assert_allclose(array["time"], 0.2)


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
        gs.open_runs(tmp_path)
    assert gs.final_values(tmp_path)["temperature"].sizes == {"run": 2}
    moments = gs.open_runs(tmp_path, densities=False)
    assert moments["temperature"].sizes == {"run": 2, "time": 3} and "f" not in moments
    assert gs.open_runs([tmp_path / "N~8.nc"])["f"].dims == ("run", "snapshot", "vx", "vy")


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
