"""Moments in closed form against integrals over velocity."""

import numpy as np
import pytest
from scipy.integrate import quad

import granstudy as gs
from granstudy.model.densities import scene_names
from granstudy.model.stated_moments import of_gaussians
from granstudy.velocity.sphere import sphere_area

ISOTROPIC = ["bkw2d", "bkw3d"] + [
    f"{name}{dim}d" for name in ("maxwellian", "uniform_ball", "power_law") for dim in (2, 3)
]


@pytest.mark.parametrize("name", ISOTROPIC)
def test_isotropic_densities_have_the_moments_they_state(name):
    scene = gs.load_scene(name)
    stated, d = scene.moments, scene.dim

    def integral(power):
        def along(r):
            v = [np.array([r]), *(np.zeros(1),) * (d - 1)]
            return float(scene.initial(*v)[0]) * r ** (d - 1 + power)

        edge = getattr(scene.initial, "radius", 5.0)
        parts = [(0.0, edge), (edge, np.inf)]
        return sphere_area(d) * sum(quad(along, *part, epsabs=1e-13)[0] for part in parts)

    mass, square, fourth = (integral(power) for power in (0, 2, 4))
    assert mass == pytest.approx(stated.density, rel=1e-9)
    assert square / d == pytest.approx(stated.temperature, rel=1e-9)
    assert d / (d + 2) * fourth / square**2 - 1 == pytest.approx(stated.a2, abs=1e-9)


@pytest.mark.parametrize("name", [n for n in scene_names() if n not in ISOTROPIC])
def test_other_densities_have_the_moments_they_state(name):
    scene = gs.load_scene(name)
    grid = gs.VelocityGrid(scene.dim, 72, 12.0)
    found, stated = gs.moments(scene.density(grid), grid), scene.moments
    assert float(found["density"]) == pytest.approx(stated.density, abs=1e-7)
    np.testing.assert_allclose(found["velocity"], stated.velocity, atol=1e-7)
    np.testing.assert_allclose(found["pressure"], stated.pressure, atol=1e-7)
    assert float(found["temperature"]) == pytest.approx(stated.temperature, abs=1e-7)
    assert float(found["a2"]) == pytest.approx(stated.a2, abs=1e-7)


def test_gaussians_are_those_of_random_velocities():
    rng = np.random.default_rng(1)
    masses, centres, variances = (0.7, 0.4), ((1.0, -2.0), (0.5, 3.0)), ((0.3, 1.2), (2.0, 0.1))
    stated = of_gaussians(masses, centres, variances)
    n = 400_000
    which = rng.choice(2, n, p=np.array(masses) / 1.1)
    v = np.array(centres)[which] + np.sqrt(variances)[which] * rng.standard_normal((n, 2))
    c = v - v.mean(axis=0)
    squared = np.sum(c**2, axis=1)
    assert stated.density == pytest.approx(1.1)
    np.testing.assert_allclose(v.mean(axis=0), stated.velocity, atol=0.02)
    np.testing.assert_allclose(1.1 * c.T @ c / n, stated.pressure, atol=0.05)
    a2 = 0.5 * np.mean(squared**2) / np.mean(squared) ** 2 - 1
    assert a2 == pytest.approx(stated.a2, abs=0.01)


@pytest.mark.parametrize(
    ("name", "fields", "message"),
    [
        ("power_law3d", {"tail": 7.0}, "tail=7.0: must be a number above 7"),
        ("uniform_ball2d", {"temperature": 0.0}, "temperature=0.0: must be a positive number"),
        ("two_beams3d", {"separation": -1.0}, "separation=-1.0: must be a positive number"),
        ("two_beams3d", {"tail": 9.0}, "unknown field of scene 'two_beams3d' 'tail'"),
    ],
)
def test_parameters_are_checked(name, fields, message):
    with pytest.raises(ValueError, match=message):
        gs.load_scene(name, **fields)


@pytest.mark.parametrize("dim", [2, 3])
def test_beams_lie_on_the_first_axis(dim):
    scene = gs.load_scene(f"two_beams{dim}d", separation=5.0, temperature=0.3)
    along = np.diag(scene.moments.pressure)
    np.testing.assert_allclose(along, [0.3 + 6.25, *(0.3,) * (dim - 1)])
    assert len(scene.symmetry) == {2: 4, 3: 16}[dim]
    # the declared symmetry is verified where the density is put on a grid
    scene.density(gs.VelocityGrid(dim, 12, 8.0))
