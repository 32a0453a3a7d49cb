"""The committed atlas: what it promises, and states computed anew."""

from pathlib import Path

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.trust.flags import Status, Trust

FILE = Path(__file__).parents[3] / "docs/results/atlas/tables/atlas.nc"
ATLAS = gs.read_dataset(FILE)


def test_it_is_small_and_whole():
    """Every number has its error, trusted ones what was asked."""
    assert FILE.stat().st_size < 1e6
    assert dict(ATLAS.sizes) == {"state": 2, "dim": 2, "exponent": 11, "e": 20}
    assert bool(np.all(ATLAS["status"] == Status.OK))
    trusted = ATLAS["trust"] == Trust.TRUSTED
    assert int(trusted.sum()) >= 868
    for name in ("a2", "a3", "cooling_coefficient", "tail_rate", "far_slope"):
        assert bool((ATLAS[name].isnull() == ATLAS[f"{name}_error"].isnull()).all())
        assert name == "a3" or bool(ATLAS[name].notnull().all())
    assert float(ATLAS["a2_error"].where(trusted).max()) <= float(ATLAS["a2_accuracy"])
    assert float(ATLAS["cooling_coefficient_error"].where(trusted).max()) <= float(
        ATLAS["accuracy"]
    )
    # a3 is missing where the sixth moment is infinite, and nowhere else.
    moments = theory.maxwell_cooling_moments(3, ATLAS["e"], ATLAS["dim"])
    infinite = np.isinf(moments.isel(order=3))
    missing = ATLAS["a3"].isnull()
    assert bool((missing.sel(state="cooling", exponent=0.0) == infinite).all())
    assert int(missing.sum()) == int(infinite.sum()) > 0


POINTS = [
    ("cooling", 2, 1.0, 0.5),
    ("cooling", 3, 0.5, 0.7),
    ("cooling", 3, 1.0, 0.0),
    ("cooling", 2, 0.0, 0.9),
    ("cooling", 3, 0.2, 0.9),
    ("heated", 2, 0.1, 0.0),
    ("heated", 3, 1.0, 0.95),
    ("heated", 3, 0.0, 0.3),
]


@pytest.mark.parametrize(("state", "dim", "exponent", "e"), POINTS)
def test_a_state_computed_anew_agrees_within_the_errors(state, dim, exponent, e):
    """On larger grids than the atlas had, so that its own errors are seen."""
    found = ATLAS.sel(state=state, dim=dim, exponent=exponent, e=e)
    heated = state == "heated"
    scene = gs.load_scene(
        f"maxwellian{dim}d", e=e, exponent=exponent, diffusion=0.1 if heated else 0.0
    )
    solve = gs.heated_state if heated else gs.cooling_state
    anew = solve(scene, accuracy=1e-6, progress=False)
    for name in ("a2", "a3", "cooling_coefficient", "tail_rate"):
        unit = float(found[name]) if name == "cooling_coefficient" else 1.0  # a relative error
        allowed = float(found[f"{name}_error"]) + float(anew[f"{name}_error"])
        assert abs(float(found[name]) - float(anew[name])) <= unit * allowed
