"""Distances from theory: small where a theory is exact, of the order of its error where it is not."""

import numpy as np
import pytest
import xarray as xr

import granstudy as gs

SOLVER = gs.Solver(N=24, R=9.0, method="radial")


def cooled(**words):
    how = {
        "t_final": words.pop("t_final", 50.0),
        "time_rtol": 1e-6,
        "frame": "rescaled",
        "progress": False,
    }
    scene = gs.load_scene("maxwellian3d", **{"e": 0.9, "exponent": 1.0, "diffusion": 0.0} | words)
    return gs.simulate(scene, SOLVER, **how)


@pytest.fixture(scope="module")
def hard():
    return cooled()


def test_a_cooling_gas_is_near_linear_theory(hard):
    distance = hard.granular.distance("a2")
    assert distance.dims == ("time",) and distance.name == "a2_distance"
    assert abs(float(distance[0])) == pytest.approx(abs(gs.theory.cooling_state_a2(0.9)))
    assert abs(float(distance[-1])) < 2e-3
    assert abs(hard.granular.distance("temperature")).max() < 5e-3
    slope = hard.granular.distance("slope")
    assert float(slope[-1]) == pytest.approx(float(hard.granular.slope()[-1]) + 2.0)


def test_an_exact_law_goes_before_others():
    distance = cooled(exponent=0.0, e=0.7, t_final=5.0).granular.distance("temperature")
    assert abs(distance).max() < 1e-6


def test_gases_of_which_theory_says_nothing_are_nan(hard):
    law = hard.drop_vars("e")
    assert np.isnan(law.granular.distance("a2")).all()


def test_the_heated_gas_is_held_against_its_own_state():
    scene = gs.load_scene("maxwellian3d", e=0.9, exponent=1.0, diffusion=0.05)
    state = gs.heated_state(scene, SOLVER)
    assert abs(float(state.granular.distance("temperature"))) < 1e-3
    assert abs(float(state.granular.distance("a2"))) < 1e-3


def test_another_quantity_is_refused(hard):
    with pytest.raises(ValueError, match="quantity.*pressure.*temperature, a2, slope"):
        hard.granular.distance("pressure")
    with pytest.raises(ValueError, match="component: the dataset has no such axis"):
        gs.Granular(xr.Dataset()).theory()
