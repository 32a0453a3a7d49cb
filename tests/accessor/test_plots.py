"""Plots of the accessor: what is drawn by default, and of which runs."""

import numpy as np
import pytest
import xarray as xr

import granstudy as gs


@pytest.fixture(scope="module")
def ds():
    """Two gases, kept at three times, one of them untrusted."""
    found = []
    for e in (0.5, 0.9):
        scene = gs.load_scene("maxwellian3d", e=e, exponent=1.0, diffusion=0.0)
        how = {"t_final": 10.0, "time_rtol": 1e-4, "frame": "rescaled", "save_every": 8}
        found.append(
            gs.simulate(scene, gs.Solver(N=24, R=9.0, method="radial"), progress=False, **how)
        )
    how = {"data_vars": "all", "coords": "different", "compat": "equals"}
    runs = xr.concat(found, "e", combine_attrs="drop_conflicts", **how)
    runs["trust"] = ("e", np.array([2, 0], np.int8))
    return runs


def legend(figure):
    return [text.get_text() for one in figure.legends for text in one.get_texts()]


def test_a_quantity_over_time_and_over_a_parameter(ds):
    figure = ds.granular.plot.temperature()
    (ax,) = figure.axes
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$t$", "$T$")
    assert legend(figure) == ["$e$ = 0.5", "$e$ = 0.9", "untrusted"]
    (ax,) = ds.granular.plot.a2("e").axes
    np.testing.assert_allclose(ax.lines[0].get_ydata(), ds["a2"].isel(time=-1))
    (ax,) = ds.granular.plot(ds.granular.haff()["C0"], "e").axes
    assert ax.get_ylabel() == "$C_0$"


def test_a_notebook_shows_a_figure(ds):
    assert ds.granular.plot.temperature()._repr_png_().startswith(b"\x89PNG")


def test_cooling_and_slopes(ds):
    left, _ = ds.granular.plot.cooling().axes
    assert sum(line.get_linestyle() == "--" for line in left.lines) == 2
    left, _ = ds.granular.plot.cooling(fit=False, scale="linear").axes
    assert left.get_xscale() == "linear" and not any(
        li.get_linestyle() == "--" for li in left.lines
    )
    _, right = ds.granular.plot.slope().axes
    expected = abs(ds.granular.slope().isel(e=0) + 2.0)
    np.testing.assert_allclose(right.lines[0].get_ydata(), expected[1:], rtol=1e-12)


def test_densities_are_the_last_of_many_runs_and_all_of_one(ds):
    assert legend(ds.granular.plot.tail())[:2] == ["$e$ = 0.5", "$e$ = 0.9"]
    one = ds.isel(e=0).granular.plot
    figure = one.over_maxwellian()
    assert sum(text.startswith("$t$ = ") for text in legend(figure)) == ds.sizes["snapshot"]
    assert legend(one.marginal(snapshot=-1)) == ["Maxwellian"]
    (ax,) = one.tail(power=1.5, snapshot=-1).axes
    assert ax.get_xlabel().endswith("$^{1.5}$") and ax.get_yscale() == "log"


def test_convergence_is_the_distance_from_the_finest():
    values = np.array([[1e-1, -1e-2, 1e-3, 0.0]])
    runs = xr.Dataset({"a2": (("e", "N"), values)}, {"e": [0.5], "N": [8, 16, 24, 32]})
    (ax,) = runs.granular.plot.convergence("a2", "N").axes
    np.testing.assert_allclose(ax.lines[0].get_ydata(), [1e-1, 1e-2, 1e-3])
    assert ax.get_yscale() == "log"


def test_early_ends_are_not_drawn_as_ends(ds):
    ended = ds.assign(status=("e", np.array([0, 2], np.int8)))
    (ax,) = ended.granular.plot.a2("e").axes
    assert list(ax.lines[0].get_xdata()) == [0.5]


def test_what_is_not_there_is_told(ds):
    with pytest.raises(ValueError, match="quantity 'temprature'.*did you mean"):
        ds.granular.plot("temprature")
    with pytest.raises(ValueError, match="x='R': must be one of e"):
        ds.granular.plot.a2("R")
