"""Densities between the nodes, in every frame and on every grid, against Gaussians in closed form."""

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.reading.densities import default_velocities
from granstudy.reading.kept import kept

TEMPERATURE = 0.8
CASES = [(2, "fast", "fixed"), (2, "fast", "rescaled"), (3, "fast", "rescaled")]
CASES += [(2, "radial", "fixed"), (3, "radial", "rescaled")]


def velocity_of(dim, method):
    return (0.5, -0.3, 0.2)[:dim] if method == "fast" else (0.0,) * dim


def gas(dim, method, frame, temperature=TEMPERATURE, **more):
    """A Maxwellian just after the start, which elastic collisions leave as it is."""
    words = {"temperature": temperature, "velocity": velocity_of(dim, method), "e": 1.0}
    scene = gs.load_scene(f"maxwellian{dim}d", **words | {"diffusion": 0.0})
    solver = gs.Solver(N=32, R=9.0, M_cir=4, M_sph=6, N_rho=4, method=method)
    how = {"t_final": 2e-4, "dt": 1e-4, "frame": frame, "save_every": 2, "progress": False}
    return gs.simulate(scene, solver, **how | more)


@pytest.fixture(scope="module", params=CASES, ids=lambda case: "-".join(map(str, case)))
def case(request):
    dim, method, frame = request.param
    return gas(dim, method, frame), dim, np.array(velocity_of(dim, method))


def gaussian(v, u=0.0, dim=1, T=TEMPERATURE):
    return np.exp(-((v - u) ** 2) / (2 * T)) / (2 * np.pi * T) ** (dim / 2)


ERRORS = {"spectral": 2e-5, "local": 3e-4}
"""The grids are coarse: polynomials of degree 15 through 16 nodes are less exact than a series."""


def close(found, exact, atol=2e-5):
    """Equal at the start and at the end."""
    assert set(found.dims) >= {"snapshot"}
    for i in range(found.sizes["snapshot"]):
        np.testing.assert_allclose(found.isel(snapshot=i), exact, atol=atol)


@pytest.mark.parametrize("method", ["spectral", "local"])
def test_f_at_points_of_a_grid_and_along_an_axis(case, method):
    ds, dim, u = case
    vx, vy = np.array([-0.9, 0.1, 0.77]), np.array([0.05, 1.3])
    cut = ds.granular.at(vx=vx, method=method)
    assert cut.dims == ("snapshot", "vx") and cut.attrs["units"] == "1"
    np.testing.assert_array_equal(cut["vx"], vx)
    rest = (2 * np.pi * TEMPERATURE) ** (-(dim - 1) / 2)
    close(cut, gaussian(vx, u[0]) * rest, ERRORS[method])
    plane = ds.granular.at(vx=vx, vy=vy, method=method)
    rest = (2 * np.pi * TEMPERATURE) ** (-(dim - 2) / 2)
    close(plane, np.multiply.outer(gaussian(vx, u[0]), gaussian(vy, u[1])) * rest, ERRORS[method])


def test_points_that_share_a_dimension_are_points(case):
    ds, dim, u = case
    angle = xr.DataArray(np.linspace(0, 2 * np.pi, 5), dims="angle")
    found = ds.granular.at(vx=u[0] + np.cos(angle), vy=u[1] + np.sin(angle))
    assert found.dims == ("snapshot", "angle")
    close(found, np.full(5, gaussian(1.0, dim=dim)))


def test_a_marginal_is_a_gaussian_of_one_component(case):
    ds, _, u = case
    v = np.linspace(-3.0, 3.0, 13)
    for i, axis in enumerate(ds["component"].values):
        close(ds.granular.marginal(axis, v), gaussian(v, u[i]))
    line = ds.granular.marginal("x")
    assert line["vx"].attrs["symbol"] == "$v_x$"
    np.testing.assert_allclose(line.integrate("vx"), 1.0, atol=1e-3)


@pytest.mark.parametrize("method", ["spectral", "local"])
def test_averages_over_directions_and_thermal_units(case, method):
    ds, dim, _ = case
    s = np.array([0.0, 0.3, 1.7, 3.0])
    close(ds.granular.radial(s, method=method), gaussian(s, dim=dim), ERRORS[method])
    c = np.array([0.0, 1.1, 3.0])
    unit = np.exp(-(c**2) / 2) / (2 * np.pi) ** (dim / 2)
    close(ds.granular.scaled(c, method=method), unit, ERRORS[method])
    close(ds.granular.scaled(c, axis="x", method=method), unit, ERRORS[method])
    close(ds.granular.over_maxwellian(c[:2], method=method), [1.0, 1.0], atol=5e-3)


def test_moments_are_those_that_the_run_recorded(case):
    ds, _, _ = case
    found = ds.granular.moments()
    at = ds.sel(time=ds["snapshot"])
    for name in found.data_vars:
        if name != "a3":
            np.testing.assert_allclose(found[name], at[name], rtol=1e-9, atol=1e-9, err_msg=name)
            assert found[name].attrs["long_name"] == ds[name].attrs["long_name"]
    np.testing.assert_allclose(found["a3"], 0.0, atol=2e-3)


def test_averages_of_any_function(case):
    ds, dim, u = case
    if "r" in ds.dims or "c" in ds.dims:
        close(ds.granular.average(lambda speed: speed**2), dim * TEMPERATURE)
    else:
        close(ds.granular.average(lambda *v: v[0]), u[0])
        close(ds.granular.average(lambda *v: (v[0] - u[0]) * (v[1] - u[1])), 0.0)


def test_a3_is_that_of_a_state():
    scene = gs.load_scene("maxwellian3d", e=0.5, exponent=1.0, diffusion=0.0)
    ds = gs.cooling_state(scene, gs.Solver(N=24, R=9.0, method="radial"))
    found = ds.granular.cumulants()
    assert float(found["a3"]) == pytest.approx(float(ds["a3"]), abs=1e-12)
    assert float(found["a2"]) == pytest.approx(float(ds["a2"]), abs=1e-12)
    assert ds.granular.scaled(np.array([0.0, 1.0])).dims == ("c",)


@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
def test_many_runs_are_read_when_they_are_used(tmp_path, frame):
    temperatures = (0.6, 0.9)
    for T in temperatures:
        # outputs at times of their own, so that each run has its own places of kept densities
        ds = gas(2, "radial", frame, T, t_final=2e-4 * T, dt=1e-4 * T)
        gs.write_dataset(ds, tmp_path / f"{T}.nc")
    runs = gs.unstack_runs(gs.open_runs(tmp_path, densities=True), ["initial_temperature"])
    found = runs.granular.scaled([0.0, 1.0])
    assert found.chunks is not None
    assert found.dims == ("initial_temperature", "kept", "c")
    np.testing.assert_allclose(found, np.exp([[[0.0, -0.5]] * 2] * 2) / (2 * np.pi), atol=1e-5)
    moments = runs.granular.moments()
    assert moments["temperature"].chunks is not None
    np.testing.assert_allclose(
        moments["temperature"], np.broadcast_to(np.array(temperatures)[:, None], (2, 2)), rtol=1e-6
    )
    exact = [[[gaussian(0.0, T=T)] * 2] for T in temperatures]
    marginal = runs.granular.marginal("y", 0.0)
    np.testing.assert_allclose(marginal, np.array(exact)[:, 0], atol=1e-5)


def test_default_velocities_hold_all_gases():
    held = kept(gas(2, "fast", "fixed"))
    v = default_velocities(held, "y")
    assert v[0] < -0.3 - 5 * TEMPERATURE**0.5 and v[-1] > -0.3 + 5 * TEMPERATURE**0.5


def test_what_cannot_be_read_is_told():
    ds = gas(2, "fast", "fixed")
    with pytest.raises(ValueError, match="vz: a density in 2D has vx, vy"):
        ds.granular.at(vz=0.0)
    with pytest.raises(ValueError, match="axis='z': a density in 2D has"):
        ds.granular.marginal("z")
    with pytest.raises(ValueError, match="vx: has shape"):
        ds.granular.at(vx=np.zeros((2, 2)))
    with pytest.raises(ValueError, match=r"vx, vy: the density has \[5, 32\] values of N=32"):
        ds.isel(vx=slice(5)).granular.at(vx=0.0)
    with pytest.raises(ValueError, match="holds no density: give simulate or time.save_every"):
        ds.drop_vars("f").granular.at(vx=0.0)
    with pytest.raises(ValueError, match="time: lacks outputs at which densities were kept"):
        ds.isel(time=slice(1, None)).granular.scaled()
    both = xr.concat([ds, ds.assign_coords(R=8.0)], "R", data_vars="all")
    with pytest.raises(ValueError, match=r"R: the runs have \[8.0, 9.0\]; select one"):
        both.granular.moments()
