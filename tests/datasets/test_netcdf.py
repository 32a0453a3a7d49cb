"""NetCDF files: whole or not at all, the same bytes for the same run, damage seen."""

import subprocess
import sys

import netCDF4
import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.datasets.netcdf import read_head
from granstudy.datasets.storage import earlier
from granstudy.datasets.storage.checksum import sealed
from granstudy.datasets.storage.classic import pack, unpack
from granstudy.datasets.storage.earlier import payload_checksum
from granstudy.support.errors import DamagedFileError

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

FLIPS = 400
"""Bits that are flipped, one at a time."""

PYTHON = sys.executable

TWICE = """
import sys
from pathlib import Path
import granstudy as gs
import xarray as xr
path = Path(sys.argv[1])
lazy = xr.open_dataset(path, engine="netcdf4", chunks={})
runs = gs.open_runs(path.parent, densities=True)
for _ in range(3):
    gs.read_dataset(path)
    gs.final_values(path.parent).load()
    with xr.open_dataset(path, engine="netcdf4") as again:
        again.load()
    lazy.compute()
    runs["f"].compute()
print("alive")
"""


def write(path, threads):
    subprocess.run([sys.executable, "-c", RUN, str(path), str(threads)], check=True)


@pytest.fixture(scope="module")
def run():
    """A small run of a gas with a restitution law, with densities."""
    scene = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1))
    solver = gs.Solver(N=8, R=7.8, N_rho=4, M_cir=4, threads=1)
    return gs.simulate(scene, solver, t_final=0.2, dt=0.1, save_every=1, progress=False)


def as_written(ds):
    """A dataset without what its file adds to it."""
    attrs = {k: v for k, v in ds.attrs.items() if k not in ("checksum", "schema_version")}
    return ds.drop_attrs(deep=False).assign_attrs(attrs)


def write_earlier(ds, path):
    """Write a dataset as the first granstudy did."""
    ds.assign_attrs(payload_sha256=payload_checksum(ds)).to_netcdf(path, engine="netcdf4")


def test_the_same_run_gives_the_same_bytes_whatever_the_threads(tmp_path):
    paths = [tmp_path / f"run{threads}.nc" for threads in (1, 2)]
    for threads, path in zip((1, 2), paths, strict=True):
        write(path, threads)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    sidecars = [path.with_name(path.name + ".json").read_text() for path in paths]
    assert sidecars[0] != sidecars[1]
    ds = gs.read_dataset(paths[0])
    assert ds["f"].sizes == {"snapshot": 3, "vx": 16, "vy": 16}


def test_a_run_comes_back_as_it_was(run, tmp_path):
    path = tmp_path / "run.nc"
    gs.write_dataset(run, path)
    back = gs.read_dataset(path)
    xr.testing.assert_identical(as_written(back), run)
    assert str(back["restitution"].values) == "viscoelastic"
    assert float(back["A"]) == 0.1
    gs.write_dataset(back, tmp_path / "again.nc")
    assert (tmp_path / "again.nc").read_bytes() == path.read_bytes()


def test_other_tools_read_the_same_and_no_text_of_variable_length(run, tmp_path):
    gs.write_dataset(run, tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc", engine="netcdf4") as stored:
        xr.testing.assert_equal(stored.load(), run)
        for name, variable in run.variables.items():
            assert stored[name].attrs.keys() == variable.attrs.keys()
            assert stored[name].attrs.get("long_name") == variable.attrs.get("long_name")
    with netCDF4.Dataset(tmp_path / "run.nc") as stored:
        assert stored.data_model == "NETCDF3_64BIT_DATA"
        assert all(variable.dtype is not str for variable in stored.variables.values())


def test_without_granstudy_a_file_opens_without_a_warning(run, tmp_path):
    gs.write_dataset(run, tmp_path / "run.nc")
    code = (
        "import sys, xarray as xr\n"
        "ds = xr.load_dataset(sys.argv[1])\n"
        "table = ds[['temperature', 'a2']].to_dataframe()\n"
        "assert not any(name.startswith('granstudy') for name in sys.modules)\n"
        "print(table['temperature'].iloc[-1].hex())\n"
    )
    command = [sys.executable, "-I", "-W", "error", "-c", code, str(tmp_path / "run.nc")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert float.fromhex(done.stdout.strip()) == float(run.temperature[-1])


def test_all_values_that_files_hold(tmp_path):
    ds = xr.Dataset(
        {
            "text": ("x", np.array(["", "θ = −1", "c"])),
            "objects": ("x", np.array(["a", "", "bc"], dtype=object)),
            "empty_text": "",
            "truth": ("x", [True, False, True]),
            "no_time": ("time", np.empty(0)),
            "no_text": (("time", "x"), np.empty((0, 3), dtype="U4")),
            **{
                f"of_{code}": ("x", np.array([0, 1, 100], dtype=code))
                for code in ("i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f4", "f8")
            },
        },
        {"x": ["a", "b", "ü"], "label": ("x", [1.0, np.nan, np.inf]), "e": -0.0},
        {"text": "λ", "none": "", "number": 2.5, "list": np.arange(3), "many": np.int64(2**40)},
    )
    gs.write_dataset(ds, tmp_path / "all.nc")
    back = gs.read_dataset(tmp_path / "all.nc")
    xr.testing.assert_identical(as_written(back), ds.assign(objects=ds["objects"].astype(str)))
    assert {n: v.dtype for n, v in back.items() if n.startswith("of_")} == {
        n: v.dtype for n, v in ds.items() if n.startswith("of_")
    }
    assert np.signbit(back["e"])
    with xr.open_dataset(tmp_path / "all.nc", engine="netcdf4") as stored:
        assert stored["text"].values.tolist() == ds["text"].values.tolist()
        assert stored["truth"].dtype == bool and stored.attrs["text"] == "λ"


@pytest.mark.parametrize(
    ("ds", "match"),
    [
        (xr.Dataset({"z": ("x", [1j])}), "z: has values of type complex128; files hold numbers"),
        (xr.Dataset(attrs={"a": {"b": 1}}), "attribute a=.*neither text"),
        (xr.Dataset(attrs={"a": ["b", "c"]}), "attribute a=.*neither text"),
        (xr.Dataset(coords={"a b": 1}), "names of coordinates have no spaces"),
    ],
)
def test_what_files_do_not_hold_is_refused(ds, match, tmp_path):
    with pytest.raises(ValueError, match=match):
        gs.write_dataset(ds, tmp_path / "no.nc")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.fault("B6")
def test_a_flipped_bit_is_seen_or_harmless(run, tmp_path):
    path = tmp_path / "run.nc"
    gs.write_dataset(run, path)
    original, data = gs.read_dataset(path), path.read_bytes()
    rng = np.random.default_rng(1)
    seen = 0
    # The first bytes, where the checksums stand, and bits anywhere.
    for bit in (*range(0, 8 * 400, 16), *rng.integers(8 * len(data), size=FLIPS - 200)):
        damaged = bytearray(data)
        damaged[bit // 8] ^= 1 << (bit % 8)
        path.write_bytes(damaged)
        try:
            xr.testing.assert_identical(gs.read_dataset(path), original)
        except DamagedFileError as error:
            assert str(path) in str(error) and "delete it, and compute the run again" in str(error)
            seen += 1
    assert seen > 0.8 * FLIPS


def test_a_flipped_bit_of_an_attribute_is_seen_in_the_head_too(run, tmp_path):
    path = tmp_path / "run.nc"
    gs.write_dataset(run, path)
    data = path.read_bytes()
    assert data.count(b"Viscoelastic(A=0.1)") == 1
    path.write_bytes(data.replace(b"Viscoelastic(A=0.1)", b"Viscoelastic(A=0.3)"))
    for read in (gs.read_dataset, read_head):
        with pytest.raises(DamagedFileError, match="do not match its checksum"):
            read(path)
    assert "A=0.3" in str(read_head(path, verify=False).attrs["scene"])


@pytest.mark.fault("B6", "B8")
def test_a_flipped_bit_of_the_checksum_is_seen_in_the_head_too(run, tmp_path):
    path = tmp_path / "run.nc"
    gs.write_dataset(run.drop_vars("f"), path)
    data = bytearray(path.read_bytes())
    data[data.index(b"checksum") + 24] ^= (
        1  # whoever reads all of it finds it damaged, so the head must not pass
    )
    path.write_bytes(data)
    for read in (gs.read_dataset, read_head):
        with pytest.raises(DamagedFileError, match="do not match its checksum"):
            read(path)


def test_damage_to_densities_is_seen_where_they_are_read(run, tmp_path):
    path = tmp_path / "run.nc"
    gs.write_dataset(run, path)
    data = bytearray(path.read_bytes())
    data[-3] ^= 1
    path.write_bytes(data)
    assert read_head(path).densities["f"].shape == (3, 8, 8)
    with pytest.raises(DamagedFileError, match="do not match its checksum"):
        gs.read_dataset(path)
    with pytest.raises(DamagedFileError, match="do not match its checksum"):
        gs.open_runs([path], densities=True)["f"].compute()


@pytest.mark.parametrize("size", [0, 3, 100, 300, 5000, -1])
def test_a_cut_file_is_damaged(run, tmp_path, size):
    path = tmp_path / "run.nc"
    gs.write_dataset(run, path)
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(DamagedFileError):
        gs.read_dataset(path)


def test_foreign_newer_and_missing_files(run, tmp_path):
    path = tmp_path / "run.nc"
    with pytest.raises(FileNotFoundError):
        gs.read_dataset(path)
    path.write_text("no dataset")
    with pytest.raises(DamagedFileError, match="it is no NetCDF file"):
        gs.read_dataset(path)
    for format, why in (("NETCDF4", "no checksum"), ("NETCDF3_64BIT_DATA", "no checksum")):
        xr.Dataset({"a": 1}).to_netcdf(path, engine="netcdf4", format=format)
        with pytest.raises(DamagedFileError, match=f"granstudy did not write it: it has {why}"):
            gs.read_dataset(path)
    back = tmp_path / "back.nc"
    gs.write_dataset(run, back)
    data = back.read_bytes()
    header = unpack(data)
    variables = {name: (v.dims, v.values(data), v.attrs) for name, v in header.variables.items()}
    blank = {"checksum": "0" * 64, "head_checksum": "0" * 64, "head_bytes": np.int64(0)}
    start, *rest = pack(header.attrs | blank | {"schema_version": np.int32(3)}, variables)
    path.write_bytes(sealed(start, rest, []) + b"".join(rest))
    with pytest.raises(ValueError, match=r"schema_version is 3, and this granstudy reads up to 2"):
        gs.read_dataset(path)


def test_files_of_earlier_granstudies(run, tmp_path):
    path = tmp_path / "run.nc"
    write_earlier(run, path)
    xr.testing.assert_equal(gs.read_dataset(path), run)
    assert read_head(path).densities["f"].shape == (3, 8, 8)
    changed = run.assign_attrs(payload_sha256=payload_checksum(run))
    changed["temperature"] = changed["temperature"] + 1e-12
    changed.to_netcdf(path, engine="netcdf4")
    with pytest.raises(DamagedFileError, match="do not match its checksum"):
        gs.read_dataset(path)


@pytest.mark.fault("B6")
def test_damaged_files_of_earlier_granstudies_raise_one_exception(run, tmp_path):
    write_earlier(run, tmp_path / "run.nc")
    data = (tmp_path / "run.nc").read_bytes()
    rng, damaged = np.random.default_rng(2), 0
    for number, bit in enumerate(rng.integers(8 * len(data), size=12)):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << (bit % 8)
        # HDF5 may keep a file open in which it found damage.
        path = tmp_path / f"{number}.nc"
        path.write_bytes(flipped)
        try:
            gs.read_dataset(path)
        except DamagedFileError:
            damaged += 1
    assert damaged


@pytest.mark.fault("B6")
@pytest.mark.parametrize(
    ("does", "message"),
    [
        ("import time; time.sleep(600)", "does not end reading it within 1 s"),
        ("import os; os.abort()", "ends with status -6 while reading it"),
    ],
)
def test_a_library_that_hangs_or_crashes_on_an_earlier_file_is_bounded(
    run, tmp_path, monkeypatch, does, message
):
    write_earlier(run, tmp_path / "run.nc")
    monkeypatch.setattr(earlier, "SECONDS", 1.0)
    monkeypatch.setattr(earlier, "_read", lambda path: pytest.fail("read in this process"))
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    script = tmp_path / "python"
    script.write_text(f"#!{PYTHON}\n{does}\n")
    script.chmod(0o755)
    with pytest.raises(DamagedFileError, match=message):
        gs.read_dataset(tmp_path / "run.nc")


@pytest.mark.fault("B11")
def test_a_file_is_opened_twice_while_an_earlier_handle_lives(run, tmp_path):
    gs.write_dataset(run, tmp_path / "run.nc")
    command = [sys.executable, "-c", TWICE, str(tmp_path / "run.nc")]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "alive\n"), done.stderr
