"""One node of each orbit, symmetrised, is the sum over all its images: exact to round-off."""

from dataclasses import replace

import numpy as np
import pytest
from comparison import assert_near, asymmetric_scene, relative_error

import granstudy as gs
from granstudy.collision.fast.gain import GainSum
from granstudy.collision.fast.operator import NodalOperator, fast_operator
from granstudy.velocity.symmetry import move


def images(operator, scene):
    """The operator without its group, over every signed image h g of its nodes, each by 1/|H|."""
    nodes, group = operator.gain.nodes, operator.group
    axes = [0, 2] if scene.dim == 2 else [0, 1, 2]
    vectors = []
    for h in sorted(group.elements):
        image = np.zeros_like(nodes.vectors)
        image[:, axes] = move(h, nodes.vectors[:, axes])
        vectors.append(image)
    order = np.argsort(np.tile(nodes.shells, len(group)), kind="stable")
    everyone = replace(
        nodes,
        vectors=np.concatenate(vectors)[order],
        weights=np.tile(nodes.weights / len(group), len(group))[order],
        shells=np.tile(nodes.shells, len(group))[order],
    )
    gain = GainSum(scene, operator.gain.grid, everyone, 1)
    trivial = gs.Symmetry.named(scene.dim, "none")
    return NodalOperator(operator.grid, gain, trivial, operator._loss)


SCENES = {
    "octahedral": ("bkw3d", {}, {"M_sph": 50, "sphere_rule": "lebedev"}),
    "product": ("bkw3d", {}, {"M_sph": 32, "sphere_rule": "product"}),
    "exchange": ("double_well3d", {}, {"M_sph": 26, "sphere_rule": "lebedev"}),
    "moving": ("maxwellian3d", {"velocity": (0.5, -0.5, 0)}, {"M_sph": 14, "sphere_rule": "lebedev"}),
    "square": ("bkw2d", {}, {"M_cir": 16}),
    "rectangle": ("bkw2d", {}, {"M_cir": 10}),
    "swap": ("double_well2d", {}, {"M_cir": 12}),
}  # fmt: skip


@pytest.mark.parametrize("restitution", [0.3, gs.Viscoelastic(0.1)], ids=str)
@pytest.mark.parametrize("variant", ["full", "separate"])
@pytest.mark.parametrize("case", SCENES)
def test_equal_to_the_sum_over_all_images(case, variant, restitution):
    # so few points do not resolve these densities: aliasing and unpaired modes are large, and equal
    N = 8 if callable(restitution) else 12
    name, overrides, rule = SCENES[case]
    scene = gs.load_scene(name, restitution=restitution, kernel=gs.VHS(0.5, 0.1), **overrides)
    solver = gs.Solver(N=N, R=7.0, N_rho=2, variant=variant, threads=1, **rule).sized()
    operator = fast_operator(scene, solver)
    everyone = images(operator, scene)
    assert len(operator.group) > 1
    assert 2 * len(operator.gain.nodes) <= len(everyone.gain.nodes)
    f = scene.density(operator.grid)
    Q = operator(f)
    assert_near(Q, everyone(f), 1e-13)
    operator.group.check(Q, "Q")


@pytest.mark.parametrize(
    ("velocity", "rule"),
    [
        ((0.0, 0.0), {"M_cir": 16}),
        ((0.3, 0.3), {"M_cir": 12}),
        ((0.0, 0.0, 0.0), {"M_sph": 26, "sphere_rule": "lebedev"}),
        ((0.3, 0.3, 0.3), {"M_sph": 14, "sphere_rule": "lebedev"}),
    ],
)
def test_differs_from_the_sum_over_pairs_by_aliasing_alone(velocity, rule):
    scene = gs.load_scene(f"maxwellian{len(velocity)}d", velocity=velocity, restitution=0.3)
    errors = []
    for N in (16, 24, 32):
        solver = gs.Solver(N=N, R=6.0, N_rho=4, **rule).sized()
        reduced = fast_operator(scene, solver)
        pairs = fast_operator(replace(scene, symmetry="none"), solver)
        assert pairs.transforms > 1.5 * reduced.transforms
        f = scene.density(pairs.grid)
        errors.append(relative_error(reduced(f), pairs(f)))
    # the products' spectrum falls like e^{−T|k|²/4}, at 32 points to 1e-4 on the last mode
    assert errors[0] > 10 * errors[1] > 100 * errors[2], errors
    assert errors[2] < 1e-3, errors


def test_transforms_saved():
    rule = {"N": 8, "R": 7.0, "N_rho": 30, "M_sph": 38, "sphere_rule": "lebedev"}
    octahedral = fast_operator(gs.load_scene("bkw3d", restitution=0.2), gs.Solver(**rule).sized())
    general = fast_operator(asymmetric_scene(3), gs.Solver(**rule).sized())
    assert octahedral.transforms == 2 * 30 * 3 + 3
    assert general.transforms == 2 * 30 * 19 + 3
    # this design has nothing but ±1 in common with the scene, and pairs use that already
    design = fast_operator(
        gs.load_scene("bkw3d", restitution=0.2), gs.Solver(8, 7.0, M_sph=70).sized()
    )
    assert len(design.group) == 1
