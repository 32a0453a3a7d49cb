"""Sweeps over functions of one's own that return a dataset."""

import numpy as np
import pytest
import xarray as xr
from gases import RADIAL, stored, sweep
from own_functions import imported, in_file, in_notebook

import granstudy as gs
from granstudy.trust.flags import Status


def line(slope, offset=0.0):
    """A dataset with an axis, an attribute, a text and a whole number."""
    x = np.linspace(0.0, 1.0, 3)
    return xr.Dataset(
        {
            "y": ("x", slope * x + offset, {"long_name": "height", "units": "m"}),
            "kind": ((), "steep" if slope > 1 else "flat"),
            "count": ((), 3),
            "up": ((), slope > 0),
        },
        {"x": ("x", x, {"units": "m"}), "twice": 2.0 * slope, "origin": "here"},
        {"made_by": "line"},
    )


def broken(slope):
    """A line, where the slope is not 2."""
    if slope == 2.0:
        raise ValueError("no such slope")
    return line(slope)


def is_held_by_a_file(ds):
    gs.write_dataset(ds, "calls.nc")
    return gs.read_dataset("calls.nc").drop_attrs(deep=False).identical(ds.drop_attrs(deep=False))


def test_what_a_function_returns_lies_over_its_arguments():
    ds = sweep(line, over={"slope": [3.0, 1.0], "offset": [0.0, 5.0]})
    assert ds["y"].dims == ("slope", "offset", "x")
    assert ds["slope"].values.tolist() == [1.0, 3.0] and ds["slope"].attrs["long_name"] == "slope"
    for slope, offset in ((1.0, 5.0), (3.0, 0.0)):
        own = line(slope, offset)["y"].values
        assert ds["y"].sel(slope=slope, offset=offset).values == pytest.approx(own)
    assert ds["y"].attrs == {"long_name": "height", "units": "m"} and ds["x"].attrs["units"] == "m"
    # Coordinates of what it returns are over the parameters that they depend on, and no other.
    assert ds["twice"].sel(slope=3.0, offset=0.0).item() == 6.0 and ds["origin"].item() == "here"
    assert ds["kind"].sel(slope=3.0, offset=0.0).item() == "steep"
    assert ds["count"].dtype == np.int64 and ds["up"].dtype == bool
    assert ds.attrs["made_by"] == "line" and (ds["status"] == Status.OK).all()
    assert is_held_by_a_file(ds)


@pytest.mark.parametrize("slopes", [[1.0, 2.0, 3.0], [2.0, 1.0], [3.0, 2.0]])
def test_a_call_that_fails_keeps_its_cause_and_the_rest_stays(slopes):
    ds = sweep(broken, over={"slope": slopes})
    bad = ds.sel(slope=2.0)
    assert bad["status"] == Status.FAILED and bad["reason"].item() == "ValueError: no such slope"
    assert bad["y"].isnull().all() and bad["kind"].item() == "" and not bad["up"].item()
    assert (ds["status"].drop_sel(slope=2.0) == Status.OK).all()
    assert ds["y"].drop_sel(slope=2.0).notnull().all()
    assert all(variable.dtype != object for variable in ds.variables.values())
    assert is_held_by_a_file(ds)


def test_a_function_in_which_the_machine_fails_is_called_again(here):
    full, log = here / "full", here / "calls"

    def writes(number):
        with open(log, "a") as file:
            file.write(f"{number}\n")
        if number == 2 and full.exists():
            raise OSError("no space left")
        return xr.Dataset({"square": number**2})

    full.touch()
    ds = sweep(writes, over={"number": [1, 2]})
    assert ds["reason"].values.tolist() == ["", "OSError: no space left"]
    assert len(stored(here / "results")) == 1
    full.unlink()
    ds = sweep(writes, over={"number": [1, 2]})
    assert ds["square"].values.tolist() == [1, 4] and ds["reason"].values.tolist() == ["", ""]
    assert log.read_text().split() == ["1", "2", "2"]


def test_calls_are_made_once_and_new_values_extend_them(here, monkeypatch):
    log = here / "calls"
    path = in_file(
        here,
        f"""
        import xarray as xr

        def square(number, power=2):
            with open({str(log)!r}, "a") as file:
                file.write(f"{{number}}\\n")
            return xr.Dataset({{"power": number**power}})
        """,
        "mine.py",
    )
    module = imported(path, monkeypatch)
    sweep(module.square, over={"number": [1, 2]}, power=2)
    sweep(module.square, power=2.0, over={"number": [1.0, 2]})
    assert log.read_text().split() == ["1", "2"]
    ds = sweep(module.square, over={"power": [2], "number": [1, 2, 3]})
    assert log.read_text().split() == ["1", "2", "3"]
    assert ds["power"].dims == ("power",) and ds.sizes == {"power": 1, "number": 3}
    # An edit of what it does calls it again; one of a comment does not.
    path.write_text(path.read_text() + "\n# seen\n")
    sweep(imported(path, monkeypatch).square, over={"number": [1]})
    assert len(log.read_text().split()) == 3
    path.write_text(path.read_text().replace("number**power", "-(number**power)"))
    monkeypatch.undo()
    monkeypatch.chdir(here)
    sweep(imported(path, monkeypatch).square, over={"number": [1]})
    assert len(log.read_text().split()) == 4


def test_a_function_of_a_notebook_that_simulates():
    cell = """
        import granstudy as gs

        def gas(e, t_final):
            scene = gs.load_scene("maxwellian2d", e=e, diffusion=0.0)
            return gs.simulate(scene, gs.Solver(N=12, R=7.0, method="radial"), t_final=t_final, dt=0.05)
    """
    ds = sweep(in_notebook(cell)["gas"], over={"e": [0.5, 0.7]}, t_final=0.1)
    scene = gs.load_scene("maxwellian2d", e=0.7, diffusion=0.0)
    own = gs.simulate(scene, RADIAL, t_final=0.1, dt=0.05, progress=False)
    assert ds["temperature"].sel(e=0.7).values.tolist() == own["temperature"].values.tolist()
    assert ds["e"].attrs["long_name"] == "restitution coefficient" and ds["N"].dims == ()
    assert is_held_by_a_file(ds)
    # Where times differ, the common axis has all of them.
    longer = sweep(in_notebook(cell)["gas"], over={"t_final": [0.1, 0.2]}, e=0.5)
    assert longer["temperature"].notnull().sum("time").values.tolist() == [3, 5]
    assert is_held_by_a_file(longer)


def test_what_depends_on_a_parameter_is_not_taken_from_the_first_point():
    """A coordinate that a function derives from its argument differs from point to point."""

    def gas(loss):
        return xr.Dataset({"T": 1.0 - loss}, {"e": (1.0 - loss) ** 0.5})

    ds = sweep(gas, over={"loss": [0.0, 0.75]})
    assert ds["e"].dims == ("loss",) and ds["e"].values.tolist() == [1.0, 0.5]


@pytest.mark.parametrize(
    ("function", "over", "fixed", "told"),
    [
        (
            line,
            {"slope": [1.0]},
            {"colour": "red"},
            "slope=1.0: line: got an unexpected .*'colour'",
        ),
        (line, {"offset": [1.0]}, {}, "offset=1.0: line: missing a required argument: 'slope'"),
        (line, {"slope": [object()]}, {}, "no content that a run can be known by"),
    ],
)
def test_calls_that_cannot_be_made_are_refused_before_any(here, function, over, fixed, told):
    with pytest.raises(ValueError, match=told):
        sweep(function, over=over, **fixed)
    assert not (here / "results").exists()


def test_settings_of_runs_are_refused_for_functions():
    with pytest.raises(ValueError, match="line is called.*load_scene"):
        sweep(line, RADIAL, over={"slope": [1.0]})


def test_results_that_do_not_fit_together_are_told():
    def growing(n):
        return xr.Dataset({"y": ("place", np.zeros(n))})

    with pytest.raises(ValueError, match="has no common axes.*place"):
        sweep(growing, over={"n": [1, 2]})

    def returns_a_number(n):
        return float(n)

    ds = sweep(returns_a_number, over={"n": [1]})
    assert "returns_a_number: returned float, must return an xarray.Dataset" in str(
        ds["reason"].values
    )

    def has_a_status(n):
        return xr.Dataset({"status": "fine"})

    ds = sweep(has_a_status, over={"n": [1]})
    assert "give it another name" in str(ds["reason"].values)


def test_a_damaged_file_is_a_hole_that_the_same_call_fills(here):
    sweep(line, over={"slope": [1.0, 2.0]})
    files = list((here / "results/.runs").glob("??/*.nc"))
    files[0].write_bytes(files[0].read_bytes()[:-1])
    ds = sweep(line, over={"slope": [1.0, 2.0]})
    assert sorted(ds["status"].values.tolist()) == [Status.OK, Status.FAILED]
    assert "its file was damaged and is removed" in " ".join(ds["reason"].values)
    assert (sweep(line, over={"slope": [1.0, 2.0]})["status"] == Status.OK).all()
    for file in files:
        file.write_bytes(b"")
    with pytest.raises(RuntimeError, match="no point can be read"):
        sweep(line, over={"slope": [1.0, 2.0]})
    assert (sweep(line, over={"slope": [1.0, 2.0]})["status"] == Status.OK).all()
