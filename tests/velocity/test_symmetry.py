"""Groups of signed permutations, on vectors and on grids."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.velocity.symmetry import (
    NAMED,
    TOLERANCE,
    Symmetry,
    apply,
    compose,
    move,
    stabiliser,
    triplet,
)

ORDERS = {
    "none": (1, 1),
    "inversion": (2, 2),
    "reflections": (4, 8),
    "exchange": (2, 6),
    "full": (8, 48),
}

each_group = pytest.mark.parametrize(
    "group", [gs.Symmetry.named(dim, name) for dim in (2, 3) for name in NAMED], ids=str
)


@pytest.mark.parametrize("name", NAMED)
def test_orders(name):
    assert tuple(len(gs.Symmetry.named(dim, name)) for dim in (2, 3)) == ORDERS[name]


@each_group
def test_it_is_a_group(group):
    products = {compose(a, b) for a in group.elements for b in group.elements}
    assert products == group.elements
    assert gs.Symmetry.named(group.dim, group.name) == group


@each_group
def test_elements_act_on_grids_as_on_vectors(group):
    def density(*v):
        x = np.stack(np.broadcast_arrays(*v), axis=-1)
        return np.sin(x @ np.arange(1, group.dim + 1)) + x[..., 0] ** 3

    grid = gs.VelocityGrid(group.dim, 6, 5.0)
    v = np.stack(np.broadcast_arrays(*grid.velocities()), axis=-1)
    for h in group.elements:
        # (h·f)(h v) = f(v), at the grid's own points
        image = apply(h, density(*grid.velocities()))
        at = np.round((move(h, v) - grid.nodes[0]) / grid.spacing).astype(int)
        values = image[tuple(np.moveaxis(at, -1, 0))]
        np.testing.assert_allclose(values, density(*grid.velocities()), rtol=1e-12)


@each_group
def test_symmetrise_is_the_mean_over_the_group(group):
    f = np.random.default_rng(1).normal(size=(6,) * group.dim)
    mean = sum(apply(h, f) for h in group.elements) / len(group)
    np.testing.assert_allclose(group.symmetrise(f), mean, atol=1e-15)
    group.check(mean, "the mean")
    for h in group.elements:
        np.testing.assert_array_equal(apply(h, group.symmetrise(f)), group.symmetrise(f))
    assert Symmetry.generated(group.dim, *map(triplet, group.generators)) == group
    assert len(group.generators) <= 5
    if len(group) > 1:
        with pytest.raises(ValueError, match="does not have it"):
            group.check(f, "noise")


@each_group
def test_the_spot_check_sees_what_the_check_sees(group):
    f = group.symmetrise(np.random.default_rng(2).uniform(1, 2, (8,) * group.dim))
    group.spot_check(f, "f")
    group.spot_check(f + 0.1 * TOLERANCE * np.random.default_rng(3).uniform(size=f.shape), "f")
    if len(group) > 1:
        with pytest.raises(ValueError, match="the density does not have it"):
            noise = np.random.default_rng(3).uniform(size=f.shape)
            group.spot_check(f + 1e-6 * noise, "the density")


@each_group
def test_what_the_spot_check_finds_symmetric_is_not_checked_at_all_points(group, monkeypatch):
    monkeypatch.delattr(Symmetry, "check")
    f = group.symmetrise(np.random.default_rng(2).uniform(1, 2, (8,) * group.dim))
    for scale in (1e-9, 1.0, 1e9):
        group.spot_check(scale * f, "f")


def test_named_scenes_declare_what_they_have():
    grids = {dim: gs.VelocityGrid(dim, 12, 7.0) for dim in (2, 3)}
    velocities = {(0.5, -0.5, 0.0): 4, (0.0, 0.0, 1.0): 8, (1.0, 2.0, 3.0): 1, (1.0, 1.0, 1.0): 6}
    scenes = [(f"bkw{d}d", {}, 8 if d == 2 else 48) for d in (2, 3)]
    scenes += [(f"double_well{d}d", {}, 2 if d == 2 else 6) for d in (2, 3)]
    scenes += [("maxwellian3d", {"velocity": u}, order) for u, order in velocities.items()]
    for name, overrides, order in scenes:
        scene = gs.load_scene(name, **overrides)
        assert len(scene.symmetry) == order
        f = scene.density(grids[scene.dim])  # verifies it
        others = list(gs.Symmetry.named(scene.dim, "full").elements - scene.symmetry.elements)
        assert all(np.max(np.abs(apply(h, f) - f)) > 1e-3 * f.max() for h in others)


def test_users_declare_theirs():
    assert len(gs.Scene(2, lambda vx, vy: np.exp(-(vx**2) - vy**2), gs.maxwell(2)).symmetry) == 1
    mirror = gs.Symmetry.generated(2, "-x,y")
    scene = gs.Scene(
        2, lambda vx, vy: np.exp(-(vx**2) - (vy - 1) ** 2), gs.maxwell(2), symmetry=mirror
    )
    scene.density(gs.VelocityGrid(2, 8, 5.0))
    assert scene.describe()["symmetry"] == "-x,y"
    assert stabiliser(gs.Symmetry.named(2, "full"), (0.0, 1.0)) == mirror
