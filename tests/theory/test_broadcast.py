"""Laws over labelled arrays: broadcast by name, with attributes; each value is that of the law at numbers."""

import inspect
import itertools

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy import theory

E = xr.DataArray([0.2, 0.5, 0.9], dims="e", coords={"e": [0.2, 0.5, 0.9]}, name="e")
DIM = xr.DataArray([2, 3], dims="dim", coords={"dim": [2, 3]})
KERNEL = xr.DataArray([gs.VHS(0.5, 0.1), gs.VHS(1.0, 0.2)], dims="gas")
TIME = xr.DataArray([0.0, 1.0, 4.0], dims="time")
T0 = xr.DataArray([1.0, 2.0], dims="start")
HALF = xr.DataArray([0.25, 1.0], dims="gas")

NUMBERS = {
    "restitution": E, "dim": DIM, "kernel": KERNEL, "t": TIME, "T0": T0, "exponent": HALF, "C0": E,
    "diffusion": 0.1, "a2": 0.05, "density": 1.2, "cross_section": 0.9, "order": 4, "a3": 0.01,
}  # fmt: skip
"""Arguments of laws by name, labelled where they can be."""

TENSORS = ("maxwell_pressure", "maxwell_third_moments", "maxwell_a2", "maxwell_moment_rates")
LAWS = [
    name for name in theory.__all__ if name not in (*TENSORS, "MomentRates", "sonine_coefficients")
]


@pytest.mark.parametrize("name", LAWS)
def test_every_law_broadcasts_over_every_argument(name):
    law = getattr(theory, name)
    given = {key: NUMBERS[key] for key in inspect.signature(law).parameters}
    if name == "cooling_correction":
        given["a2"] = E
    found = law(**given)
    assert found.name == name and found.attrs["long_name"] and found.attrs["units"] == "1"
    assert found.attrs["symbol"]
    dims = dict.fromkeys(d for v in given.values() if isinstance(v, xr.DataArray) for d in v.dims)
    assert set(dims) <= set(found.dims)
    sizes = [range(found.sizes[dim]) for dim in dims]
    for place in itertools.product(*sizes):
        at = dict(zip(dims, place, strict=True))
        numbers = {
            key: v.isel({d: at[d] for d in v.dims}).item() if isinstance(v, xr.DataArray) else v
            for key, v in given.items()
        }
        np.testing.assert_allclose(found.isel(at).values, law(**numbers), rtol=1e-13)


def test_arrays_of_numpy_broadcast_by_position():
    e = E.values
    np.testing.assert_array_equal(
        theory.maxwell_tail_exponent(e, 3), [theory.maxwell_tail_exponent(one, 3) for one in e]
    )
    found = theory.maxwell_cooling_moments(3, e[:, None], np.array([2, 3]))
    assert found.shape == (3, 2, 4)
    np.testing.assert_array_equal(found[1, 1], theory.maxwell_cooling_moments(3, 0.5, 3))
    np.testing.assert_allclose(theory.haff_constant(gs.hard_spheres(3), e, 3).shape, (3,))


def test_the_law_of_a_dataset_takes_its_coordinates():
    C0 = theory.haff_constant(gs.hard_spheres(3), E, 3)
    T = theory.haff_temperature(TIME, 2.0, C0)
    assert T.dims == ("time", "e") and T.name == "haff_temperature"
    np.testing.assert_allclose(
        T.sel(e=0.5), theory.haff_temperature(TIME.values, 2.0, float(C0[1]))
    )


def test_nan_gives_nan():
    e = xr.DataArray([np.nan, 0.5], dims="run")
    found = theory.cooling_state_a2(e)
    assert np.isnan(found[0]) and found[1] == theory.cooling_state_a2(0.5)


def test_tensors_are_taken_whole_over_whatever_else_there_is():
    P = np.array([[1.3, 0.2], [0.2, 0.7]])
    pressure = xr.DataArray([P, 2 * P], dims=("start", "i", "j"))
    found = theory.maxwell_pressure(TIME, pressure, E)
    assert set(found.dims) == {"time", "start", "e", "i", "j"}
    np.testing.assert_allclose(
        found.isel(start=1, e=0).transpose("time", "i", "j"),
        theory.maxwell_pressure(TIME.values, 2 * P, 0.2),
    )
    a2 = theory.maxwell_a2(TIME, P, 0.1, E)
    assert set(a2.dims) == {"e", "time"}
    np.testing.assert_allclose(a2.isel(e=2), theory.maxwell_a2(TIME.values, P, 0.1, 0.9))
    third = np.random.default_rng(1).standard_normal((2, 2, 2))
    rates = theory.maxwell_moment_rates(1.0, P, third, 3.0, E)
    assert [rate.name for rate in rates] == ["pressure", "third", "fourth"]
    for rate, exact in zip(
        rates, theory.maxwell_moment_rates(1.0, P, third, 3.0, 0.5), strict=True
    ):
        np.testing.assert_allclose(rate.isel(e=1), exact)
    moments = theory.maxwell_heated_moments(3, E, 3)
    a2, a3 = theory.sonine_coefficients(moments)
    assert (a2.name, a3.name) == ("a2", "a3")
    np.testing.assert_allclose(
        (a2[1], a3[1]), theory.sonine_coefficients(theory.maxwell_heated_moments(3, 0.5, 3))
    )


def test_an_elastic_gas_stands_beside_others():
    found = theory.maxwell_temperature(TIME, 1.0, xr.DataArray([0.5, 1.0], dims="e"), 0.1)
    np.testing.assert_allclose(found.isel(e=1), 1.0 + 0.2 * TIME)


def test_what_a_law_refuses_it_refuses_in_an_array():
    with pytest.raises(ValueError, match="restitution="):
        theory.cooling_state_a2(xr.DataArray([0.5, 1.5], dims="e"))
    with pytest.raises(ValueError, match="exponent=0"):
        theory.haff_temperature(TIME, 1.0, 1.0, xr.DataArray([0.0, 1.0], dims="gas"))
