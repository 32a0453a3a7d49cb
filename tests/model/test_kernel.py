import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import granstudy as gs
from granstudy.model.restitution import C1, check_restitution
from granstudy.velocity.sphere import sphere_area


def test_kernels_of_the_paper():
    assert gs.maxwell(2) == gs.VHS(exponent=0.0, strength=1 / (2 * np.pi))
    assert gs.maxwell(3) == gs.VHS(exponent=0.0, strength=1 / (4 * np.pi))
    assert gs.hard_spheres(3) == gs.VHS(exponent=1.0, strength=1 / (4 * np.pi))
    for dim in (2, 3):
        assert gs.maxwell(dim).strength * sphere_area(dim) == pytest.approx(1.0)


@pytest.mark.fault("D2")
def test_the_coefficient_of_the_viscoelastic_law():
    assert C1 == pytest.approx(1.15345, abs=2e-6)
    assert gs.Viscoelastic(A=0.1)(np.ones(1))[0] == pytest.approx(
        1 - 0.1 * C1 + 0.6 * (0.1 * C1) ** 2
    )


def test_viscoelastic_law():
    law = gs.Viscoelastic(A=0.1)
    assert law(0.0) == 1.0
    s = 0.1 * C1 * 2.0**0.2
    assert law(2.0) == pytest.approx(1 - s + 0.6 * s**2, rel=1e-14)
    speeds = np.linspace(0.0, 10.0, 101)
    assert np.all(np.diff(law(speeds)) < 0)  # faster impacts lose a larger share
    assert np.all(gs.Viscoelastic(A=0.0)(speeds) == 1.0)


@given(st.floats(0.0, 0.9), st.floats(0.1, 10.0))
def test_viscoelastic_law_is_allowed_where_documented(A, largest):
    # within [0, 1] until C₁ A v^{1/5} exceeds 5/3, and nowhere below 7/12
    if C1 * A * largest**0.2 < 5 / 3 - 1e-9:
        check_restitution(gs.Viscoelastic(A), largest)
        assert np.all(gs.Viscoelastic(A)(np.linspace(0, largest, 99)) >= 7 / 12 - 1e-12)
    elif C1 * A * largest**0.2 > 5 / 3 + 1e-9:
        with pytest.raises(ValueError, match="restitution=Viscoelastic"):
            check_restitution(gs.Viscoelastic(A), largest)


@pytest.mark.parametrize("e", [0, 1, 0.5, np.float64(0.3), np.float32(1.0), lambda g: 0 * g])
def test_allowed_restitutions(e):
    check_restitution(e)
