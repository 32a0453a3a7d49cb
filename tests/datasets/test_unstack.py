"""From runs in a row to an array over their parameters."""

import numpy as np
import pytest
import xarray as xr

import granstudy as gs


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Five of the eight runs over two e, two N and two variants."""
    path = tmp_path_factory.mktemp("runs")
    for e, N, variant in (
        (0.2, 8, "full"),
        (0.2, 16, "full"),
        (0.2, 16, "separate"),
        (0.8, 8, "full"),
        (0.8, 16, "separate"),
    ):
        solver = gs.Solver(N=N, R=7.8, N_rho=6, M_cir=6, variant=variant, threads=1)
        ds = gs.simulate(gs.load_scene("bkw2d", restitution=e), solver, t_final=0.2, dt=0.1)
        gs.write_dataset(ds, path / f"e~{e}/N~{N}/variant~{variant}.nc")
    return path


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


def test_laws_text_and_own_arguments_become_dimensions():
    runs = xr.Dataset(
        {
            "T": ("run", [1.0, 2.0, 3.0, 4.0]),
            "status": ("run", np.zeros(4, np.int8)),
            "n": ("run", [1, 2, 3, 4]),
        },
        {
            "e": ("run", [0.5, 0.5, np.nan, np.nan], {"long_name": "restitution e"}),
            "restitution": ("run", ["", "", "law(1)", "law(1)"]),
            "ratio": ("run", [2.0, 1.0, 1.0, 2.0]),
            "kind": ("run", ["b", "b", "b", "b"]),
        },
    )
    array = gs.unstack_runs(runs, ("e", "ratio"))
    assert array["T"].dims == ("e", "ratio") and array["e"].attrs == {"long_name": "restitution e"}
    np.testing.assert_array_equal(array["e"], [0.5, np.nan])
    np.testing.assert_array_equal(array["T"], [[2.0, 1.0], [3.0, 4.0]])
    assert array["kind"].item() == "b"
    assert array["restitution"].dims == ("e", "ratio")
    whole = gs.unstack_runs(runs)
    assert whole["T"].dims == ("e", "restitution", "ratio")
    np.testing.assert_array_equal(whole["T"].sel(restitution="law(1)")[1], [3.0, 4.0])
    assert (whole["status"] == -1).sum() == 4 and whole["status"].dtype == np.int8
    assert (whole["n"] == -1).sum() == 4
    assert np.isnan(whole["T"].sel(e=0.5, restitution="law(1)")).all()


def test_densities_stay_on_disk(tmp_path):
    for e in (0.2, 0.8):
        solver = gs.Solver(N=8, R=7.0, method="radial", threads=1)
        scene = gs.load_scene("maxwellian2d", restitution=e)
        ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, save_every=1)
        gs.write_dataset(ds, tmp_path / f"{e}.nc")
    array = gs.unstack_runs(gs.open_runs(tmp_path, densities=True), ["e"])
    assert array["f"].chunks is not None and array["f"].dims == ("e", "snapshot", "r")
    np.testing.assert_array_equal(array["f"][1], ds["f"])
