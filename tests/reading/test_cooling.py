"""Cooling laws are recovered from what they made; where none holds, NaN has a reason."""

import numpy as np
import pytest
import xarray as xr

from granstudy.reading.cooling import fit_haff, haff, heated_cooling, local_slope, slopes
from granstudy.theory import haff_temperature


@pytest.mark.fault("A3")
@pytest.mark.parametrize(("C0", "T0"), [(0.19058, 2.0), (0.5159, 2.0), (5.0, 0.01)])
def test_a_haff_constant_is_recovered(C0, T0):
    t = np.linspace(0.0, 3.0, 301)
    fit = fit_haff(t, haff_temperature(t, T0, C0))
    assert fit.C0 == pytest.approx(C0, rel=1e-7)
    assert fit.C0_error < 1e-7 * C0


def test_the_initial_temperature_is_held():
    t = np.linspace(0.0, 3.0, 301)
    T = haff_temperature(t, 2.0, 0.5)
    from_start = fit_haff(t[100:], T[100:], T0=2.0)
    assert from_start.C0 == pytest.approx(0.5, rel=1e-7)
    too_warm = fit_haff(t, T, T0=2.2)
    assert too_warm.C0 > 0.52
    assert too_warm.C0_error > 1e-4


def test_the_standard_error_covers_noise():
    t = np.linspace(0.0, 3.0, 301)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    fit = fit_haff(t, haff_temperature(t, 2.0, 0.5) + noise, T0=2.0)
    assert abs(fit.C0 - 0.5) < 4.0 * fit.C0_error
    assert fit.C0_error < 1e-3


@pytest.mark.fault("A3")
@pytest.mark.parametrize(
    ("t", "T", "message"),
    [([0.0, 1.0], [1.0, 0.5], "three"), ([0.0, 1.0, 2.0], [1.0, 0.5, np.nan], "finite")],
)
def test_a_cooling_law_needs_data(t, T, message):
    with pytest.raises(ValueError, match=message):
        fit_haff(t, T)


@pytest.mark.fault("A3")
def test_the_local_slope_of_a_power_and_of_haffs_law():
    t = np.geomspace(1e-2, 1e6, 81)
    at, slope = local_slope(t, 3.0 * t**-1.7)
    np.testing.assert_allclose(slope, -1.7, rtol=1e-12)
    assert np.all((t[:-1] < at) & (at < t[1:]))
    C0 = 0.2
    at, slope = local_slope(t, (1.0 + C0 * t) ** -2)
    np.testing.assert_allclose(slope, -2 * C0 * at / (1 + C0 * at), atol=2e-3)
    np.testing.assert_allclose((slope + 2)[-5:] * C0 * at[-5:], 2.0, rtol=0.02)


def test_standard_errors_are_those_of_many_repetitions():
    t, rng = np.linspace(0.0, 5.0, 101), np.random.default_rng(2)
    exact = haff_temperature(t, 2.0, 0.5, 0.5)
    fits = [
        fit_haff(
            t,
            exact * (1.0 + 1e-3 * rng.standard_normal(t.size)),
            None,
            0.5,
            free=True,
            relative=True,
        )
        for _ in range(200)
    ]
    for name in ("T0", "C0"):
        spread = np.std([getattr(fit, name) for fit in fits])
        stated = np.mean([getattr(fit, f"{name}_error") for fit in fits])
        assert stated == pytest.approx(spread, rel=0.15)


@pytest.mark.fault("A3")
def test_heated_cooling_is_haffs_law_without_heat_and_steady_where_heat_balances():
    t = np.linspace(0.0, 4.0, 9)
    np.testing.assert_allclose(
        heated_cooling(t, 2.0, 0.5, 0.7, 0.0), haff_temperature(t, 2.0, 0.5, 0.7), rtol=1e-8
    )
    # T' = 2ε − (2/λ) C0 T0 at T = T0
    np.testing.assert_allclose(heated_cooling(t, 2.0, 0.5, 0.7, 0.5 * 2.0 / 0.7), 2.0, rtol=1e-8)


def runs_of(gases, t):
    """Runs over ``gas`` with T of each: (exponent, diffusion, e, status, T)."""
    exponent, diffusion, e, status, T = zip(*gases, strict=True)
    return xr.Dataset(
        {
            "temperature": (("gas", "time"), np.array(T)),
            "status": ("gas", np.array(status, dtype=np.int8)),
        },
        {
            "time": t,
            "gas": np.arange(len(gases)),
            "e": ("gas", list(e)),
            "exponent": ("gas", list(exponent)),
            "diffusion": ("gas", list(diffusion)),
        },
    )


T = np.linspace(0.0, 4.0, 41)


@pytest.mark.fault("A3")
def test_every_run_gets_the_law_of_its_own_kernel():
    gases = [
        (exponent, 0.0, 0.5, 0, haff_temperature(T, 2.0, 0.4 * exponent, exponent))
        for exponent in (0.25, 0.5, 1.0)
    ]
    found = haff(runs_of(gases, T))
    np.testing.assert_allclose(found["C0"], [0.1, 0.2, 0.4], rtol=1e-6)
    np.testing.assert_allclose(found["power"], [-8.0, -4.0, -2.0])
    assert (found["reason"] == "").all()
    assert found["C0"].attrs["symbol"] == "$C_0$"
    np.testing.assert_array_equal(found["e"], 0.5)


@pytest.mark.fault("A3")
def test_a_law_fitted_from_a_start_on_forgets_what_was_before():
    late = T >= 1.0
    law = np.where(late, haff_temperature(T - 1.0, 1.5, 0.3), 7.0)
    runs = runs_of([(1.0, 0.0, 0.5, 0, law)], T)
    found = haff(runs, start=1.0).isel(gas=0)
    assert float(found["T0"]) == pytest.approx(1.5, rel=1e-6)
    assert float(found["C0"]) == pytest.approx(0.3, rel=1e-6)
    assert float(haff(runs)["residual"][0]) > 0.1


@pytest.mark.fault("A3")
def test_heating_is_refused_or_modelled():
    law = heated_cooling(T, 2.0, 0.4, 1.0, 0.05)
    runs = runs_of([(1.0, 0.05, 0.5, 0, law)], T)
    refused = haff(runs)
    assert np.isnan(refused["C0"]) and "heated by diffusion 0.05" in refused["reason"].item()
    assert float(haff(runs, heating="modelled")["C0"][0]) == pytest.approx(0.4, rel=1e-5)
    with pytest.raises(ValueError, match="heating='some': allowed are refused, modelled"):
        haff(runs, heating="some")


@pytest.mark.fault("A3")
@pytest.mark.parametrize(
    ("gas", "reason"),
    [
        ((0.0, 0.0, 0.5, 0), "exponent 0: Maxwell molecules cool exponentially"),
        ((1.0, 0.0, 1.0, 0), "e = 1: elastic collisions take no energy"),
        ((1.0, 0.0, 0.5, 2), "the run ended early"),
        ((1.0, 0.0, 0.5, -1), "there is no run"),
    ],
)
def test_where_no_law_holds_nan_has_a_reason(gas, reason):
    sound = (1.0, 0.0, 0.5, 0, haff_temperature(T, 2.0, 0.4))
    found = haff(runs_of([(*gas, np.full(T.size, 2.0)), sound], T))
    assert np.isnan(found["C0"][0]) and found["C0"][1] == pytest.approx(0.4)
    assert reason in found["reason"].values[0] and found["reason"].values[1] == ""


@pytest.mark.fault("A3")
def test_too_few_outputs_are_a_reason():
    found = haff(runs_of([(1.0, 0.0, 0.5, 0, haff_temperature(T, 2.0, 0.4))], T), start=3.85)
    assert found["reason"].item() == "2 outputs from t = 3.85 on; a fit needs 3"


def test_slopes_are_over_the_runs_own_times():
    t = np.geomspace(1.0, 100.0, 9)
    runs = xr.Dataset(
        {"temperature": (("run", "output"), np.array([t**-2.0, (3 * t) ** -0.5]))},
        {"time": (("run", "output"), np.array([t, 3 * t])), "e": ("run", [0.5, 0.9])},
    )
    found = slopes(runs)
    assert found.dims == ("run", "output") and found.sizes["output"] == 8
    np.testing.assert_allclose(found.isel(run=0), -2.0)
    np.testing.assert_allclose(found.isel(run=1), -0.5)
    np.testing.assert_allclose(found["time"].isel(run=1), 3 * np.sqrt(t[1:] * t[:-1]))
    shared = xr.Dataset({"temperature": (("e", "time"), [t**-2.0])}, {"time": t, "e": [0.5]})
    assert slopes(shared)["time"].dims == ("time",)
    with pytest.raises(ValueError, match="quantity='a2': the runs have none over time"):
        slopes(shared, "a2")
