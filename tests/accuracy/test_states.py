"""States to an accuracy, against finer ones; and a2 that does not exist."""

import json

import pytest

import granstudy as gs
from granstudy.trust.flags import Trust


def gas(exponent, e, diffusion=0.0):
    kernel = gs.VHS(exponent, gs.hard_spheres(3).strength)
    return gs.Scene(3, "maxwellian3d", kernel, restitution=e, diffusion=diffusion)


@pytest.mark.parametrize("asked", [1e-3, 1e-5])
@pytest.mark.parametrize("heated", [False, True])
def test_a_state_keeps_its_word(heated, asked):
    scene = gas(1.0, 0.5, 0.1 if heated else 0.0)
    find = gs.heated_state if heated else gs.cooling_state
    fine = find(scene, gs.Solver(N=48, R=14.0, method="radial"), progress=False)
    ds = find(scene, accuracy=asked, progress=False)
    for name, most in (("a2", 10 * asked), ("cooling_coefficient", asked)):
        off = abs(float(ds[name]) - float(fine[name]))
        assert off <= most
        assert off <= float(ds[f"{name}_error"]) <= most
    assert "needed" not in ds.attrs
    assert ds["trust"].item() == Trust.TRUSTED
    assert json.loads(ds.attrs["asked"]) == {"temperature": asked, "a2": pytest.approx(10 * asked)}


def test_an_a2_that_does_not_exist_is_said(monkeypatch):
    monkeypatch.setattr("granstudy.accuracy.states.LADDER", ((16, 8.0), (20, 10.0), (24, 12.0)))
    ds = gs.cooling_state(gas(0.0, 0.2), accuracy=1e-4, progress=False)
    assert "a2 does not exist" in ds.attrs["needed"]
    assert ds["trust"].item() == Trust.UNTRUSTED
    assert "a2 does not exist" in ds["trust"].attrs["reasons"]
