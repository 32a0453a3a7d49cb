"""A run is computed anew from what its file says, code of the user included."""

from pathlib import Path

import pytest

import granstudy as gs
from granstudy.workbench.verifying import verify_dataset

GAS = """
import numpy as np

HALF = 2.0

def anisotropic(vx, vy, ratio=1.0):
    return np.exp(-vx**2 / (HALF * ratio) - vy**2 / HALF) / (HALF * np.pi * np.sqrt(ratio))

def softening(v, kappa=0.1):
    return 1.0 / (1.0 + kappa * v)
"""


@pytest.fixture
def own_gas(tmp_path, monkeypatch):
    (tmp_path / "my_gas.py").write_text(GAS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("my_gas.py:anisotropic", {"e": 0.8, "ratio": 2.0, "symmetry": "reflections"}),
        ("maxwellian2d", {"restitution": "my_gas.py:softening", "kappa": 0.2}),
    ],
)
def test_a_gas_of_ones_own_is_the_same_bit_for_bit_by_the_code_in_its_file(own_gas, scene, words):
    solver = gs.Solver(N=16, R=8.0, M_cir=8, N_rho=8)
    gs.sweep(scene, solver, over={"exponent": [1.0]}, t_final=0.1, dt=0.05, workers=1, **words)
    (file,) = Path("results/.runs").glob("??/*.nc")
    verdict = verify_dataset(file, run_code=True)
    assert verdict.same_code
    assert verdict.differences == {}
    with pytest.raises(ValueError, match="runs only when told to"):
        verify_dataset(file)
