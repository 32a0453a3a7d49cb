"""NetCDF files: whole or not at all, the same bytes for the same run, damage seen."""

import subprocess
import sys

import pytest
import xarray as xr

import granstudy as gs

RUN = """
import sys
import granstudy as gs
ds = gs.simulate(
    gs.load_scene("bkw2d", restitution=0.5),
    gs.Solver(N=16, R=7.8, N_rho=8, M_cir=8, threads=int(sys.argv[2])),
    t_final=0.2, dt=0.1, save_every=1, progress=False,
)
gs.write_dataset(ds, sys.argv[1], duration=float(sys.argv[2]))
"""


def write(path, threads):
    subprocess.run([sys.executable, "-c", RUN, str(path), str(threads)], check=True)


def test_the_same_run_gives_the_same_bytes_whatever_the_threads(tmp_path):
    paths = [tmp_path / f"run{threads}.nc" for threads in (1, 2)]
    for threads, path in zip((1, 2), paths, strict=True):
        write(path, threads)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    sidecars = [path.with_name(path.name + ".json").read_text() for path in paths]
    assert sidecars[0] != sidecars[1]
    ds = gs.read_dataset(paths[0])
    assert ds["f"].sizes == {"snapshot": 3, "vx": 16, "vy": 16}


def test_round_trip_and_damage(tmp_path):
    path = tmp_path / "run.nc"
    scene = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1))
    ds = gs.simulate(
        scene, gs.Solver(N=8, R=7.8, N_rho=4, M_cir=4), t_final=0.2, dt=0.1, progress=False
    )
    gs.write_dataset(ds, path)
    back = gs.read_dataset(path)
    xr.testing.assert_identical(back.drop_attrs(deep=False), ds.drop_attrs(deep=False))
    assert str(back["restitution"].values) == "viscoelastic"
    assert float(back["A"]) == 0.1

    back["temperature"][1] += 1e-12
    back.to_netcdf(path, engine="netcdf4")
    with pytest.raises(ValueError, match="does not match its checksum"):
        gs.read_dataset(path)
    xr.Dataset({"a": 1}).to_netcdf(path, engine="netcdf4")
    with pytest.raises(ValueError, match="granstudy did not write it"):
        gs.read_dataset(path)
