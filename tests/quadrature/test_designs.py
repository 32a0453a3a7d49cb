"""The design files, the harmonics they are judged by, and the program that made them."""

import subprocess
import sys
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.special import sph_harm_y

from granstudy.quadrature import designs, sphere_rule
from granstudy.quadrature.design_data import DESIGN_DEGREE, design_points
from granstudy.quadrature.harmonics import exact_degree, harmonic_gradients, harmonics, residual
from granstudy.quadrature.orbits import representatives
from granstudy.velocity.symmetry import Symmetry, move

MODES = np.array([(l, m) for l in range(20) for m in range(-l, l + 1)])  # noqa: E741


def random_points(count: int, seed: int = 0) -> np.ndarray:
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


@pytest.mark.parametrize(("M_sph", "degree"), DESIGN_DEGREE.items())
def test_every_shipped_file_is_a_symmetric_design(M_sph, degree):
    points = design_points(M_sph)
    assert points.shape == (M_sph, 3)
    assert np.array_equal(points[M_sph // 2 :], -points[: M_sph // 2])
    assert np.abs(np.linalg.norm(points, axis=1) - 1).max() < 3e-16
    assert residual(points, degree) < 1e-15
    assert exact_degree(points) == degree


@pytest.mark.parametrize("M_sph", DESIGN_DEGREE)
def test_shipped_designs_have_their_groups_to_the_last_bit(M_sph):
    points, orbits = design_points(M_sph), designs.ORBITS.get(M_sph, designs.Orbits())
    group = Symmetry.generated(3, "-x,-y,-z", *orbits.generators)
    for h in group.elements:
        assert set(map(tuple, move(h, points))) == set(map(tuple, points))
    assert len(representatives(sphere_rule(M_sph), group)) == orbits.free_count(M_sph)
    if len(group) == 2:
        assert np.array_equal(points[0], [0, 0, 1])


def test_points_are_well_separated():
    # no set of M points is separated by more than about sqrt(8π/(√3 M)) (hexagonal packing)
    for M_sph in list(DESIGN_DEGREE)[3:]:
        packing = np.degrees(np.sqrt(8 * np.pi / (np.sqrt(3) * M_sph)))
        assert designs.smallest_angle(design_points(M_sph)) > 0.75 * packing, M_sph


def test_sums_agree_with_the_addition_theorem():
    # Σ_m (Σ_i Y_lm(x_i)/M)² = (2l+1) Σ_ij P_l(x_i·x_j)/M²; the right side knows no harmonics
    points = random_points(17)
    for degree in (1, 2, 7, 19):
        modes = MODES[MODES[:, 0] == degree]
        sums = harmonics(points, modes).mean(axis=1)
        P = np.polynomial.legendre.Legendre.basis(degree)(points @ points.T)
        assert np.sum(sums**2) == pytest.approx((2 * degree + 1) * P.mean(), rel=1e-11)


def test_harmonics_are_scipys():
    points = random_points(9)
    theta, phi = np.arccos(points[:, 2]), np.arctan2(points[:, 1], points[:, 0])
    for (degree, m), values in zip(MODES, harmonics(points, MODES), strict=True):
        Y = sph_harm_y(degree, abs(m), theta, phi) * np.sqrt(4 * np.pi)
        expected = Y.real if m == 0 else np.sqrt(2) * (-1) ** abs(m) * (Y.real if m > 0 else Y.imag)
        np.testing.assert_allclose(values, expected, atol=1e-12, err_msg=f"l={degree}, m={m}")


def test_gradients_are_tangential_and_match_differences():
    points, h = random_points(5), 1e-5
    along = np.cross(points, random_points(5, seed=1))
    gradients = harmonic_gradients(points, MODES)
    assert np.abs(np.sum(gradients * points, axis=-1)).max() < 1e-12

    def moved(step):
        shifted = points + step * along
        return harmonics(shifted / np.linalg.norm(shifted, axis=1)[:, None], MODES)

    difference = (moved(h) - moved(-h)) / (2 * h)
    np.testing.assert_allclose(np.sum(gradients * along, axis=-1), difference, atol=2e-6)


def test_harmonics_keep_the_precision_of_the_points():
    points = random_points(4)
    precise = harmonics(points.astype(np.longdouble), MODES)
    assert precise.dtype == np.longdouble
    assert harmonic_gradients(points.astype(np.longdouble), MODES).dtype == np.longdouble
    np.testing.assert_allclose(precise.astype(float), harmonics(points, MODES), atol=1e-12)


def test_residual_sees_what_is_not_a_design():
    assert residual(random_points(32), 7) > 1e-2
    points = design_points(32).copy()
    points[5] = Rotation.from_rotvec([0, 1e-6, 0]).apply(points[5])
    assert 1e-9 < residual(points, 7) < 1e-6
    assert exact_degree(points) < 7
    assert residual(points, 0) == 0.0


def test_residual_knows_weights():
    points = design_points(12)
    doubled, weights = np.vstack([points, points[:4]]), np.ones(16)
    weights[:4] = weights[12:] = 0.5
    assert residual(doubled, 5) > 1e-2
    assert residual(doubled, 5, weights) < 1e-15
    assert exact_degree(doubled, weights) == 5


@given(st.integers(0, 2**32 - 1), st.sampled_from(list(DESIGN_DEGREE)))
def test_a_design_turned_is_a_design(seed, M_sph):
    turned = Rotation.random(rng=np.random.default_rng(seed)).apply(design_points(M_sph))
    assert residual(turned, DESIGN_DEGREE[M_sph]) < 1e-14


@pytest.mark.parametrize("M_sph", [2, 6, 12])
def test_the_program_reproduces_the_polyhedra(M_sph):
    design = designs.compute_design(M_sph, starts=2)
    assert design.degree == DESIGN_DEGREE[M_sph]
    shipped = design_points(M_sph)
    distance = np.linalg.norm(design.points[:, None] - shipped[None], axis=-1).min(axis=1)
    # the same polyhedron, first point at the pole and its neighbour at y = 0
    assert distance.max() < 1e-14


def test_the_program_finds_a_design_of_32_points():
    design = designs.compute_design(32, starts=1)
    assert residual(design.points, 7) < 1e-15
    assert np.array_equal(design.points, designs.compute_design(32, starts=1).points)


SETS = [
    designs.Orbits(),
    designs.Orbits(("y,z,x",)),
    designs.Orbits(("-y,x,z",), in_plane=2),
    designs.Orbits(("x,y,-z", "y,z,x"), in_plane=1),
]


def free_points(orbits, count: int = 4, seed: int = 0) -> np.ndarray:
    return orbits.points(random_points(count, seed))[0]


@pytest.mark.parametrize("orbits", SETS)
def test_the_set_is_all_distinct_images(orbits):
    points = orbits.all_points(free_points(orbits))
    in_full = 4 - orbits.in_plane / 2
    assert len(points) == 2 * len(orbits.group) * in_full
    assert orbits.free_count(len(points)) == 4
    assert len(np.unique(points.round(12), axis=0)) == len(points)
    half = len(points) // 2
    assert np.array_equal(points[half:], -points[:half])
    assert np.all(points[:half, 2] >= 0)


@pytest.mark.parametrize("orbits", SETS)
def test_means_over_orbits_are_means_over_the_set(orbits):
    free = free_points(orbits)
    modes = designs.even_modes(9)
    everyone = harmonics(orbits.all_points(free), modes).mean(axis=1)
    np.testing.assert_allclose(designs.means(free, modes, orbits), everyone, atol=1e-14)


@pytest.mark.parametrize("orbits", SETS)
def test_gradients_of_the_means_match_differences(orbits):
    free, modes = free_points(orbits), designs.even_modes(9)
    along = np.random.default_rng(1).normal(size=free.shape)
    along[: orbits.in_plane, 2] = 0
    gradients = designs.mean_gradients(free, modes, orbits)
    forward, backward = (
        designs.means(orbits.points(free + h * along)[0], modes, orbits) for h in (1e-5, -1e-5)
    )
    slopes = np.tensordot(gradients, along, axes=2)
    np.testing.assert_allclose(slopes, (forward - backward) / 2e-5, atol=1e-8)


@pytest.mark.parametrize(
    ("generators", "degree", "independent"),
    [((), 7, 27), ((), 15, 119), (("y,z,x",), 15, 39), (("y,z,x",), 19, 63), (("-y,x,z",), 7, 7)],
)
def test_as_many_sums_are_independent_as_harmonics_have_invariants(generators, degree, independent):
    modes, orbits = designs.even_modes(degree), designs.Orbits(generators)
    values = [designs.means(random_points(1, seed), modes, orbits) for seed in range(130)]
    assert np.linalg.matrix_rank(np.array(values), tol=1e-10) == independent


@pytest.mark.parametrize("orbits", SETS)
def test_energy_gradient_matches_differences(orbits):
    u, step = free_points(orbits, 5).ravel(), np.random.default_rng(4).normal(size=15)
    step[2 : 3 * orbits.in_plane : 3] = 0
    slope = designs._energy(u, orbits)[1] @ step
    forward, backward = (designs._energy(u + h * step, orbits)[0] for h in (1e-6, -1e-6))
    assert slope == pytest.approx((forward - backward) / 2e-6, rel=1e-6)


@pytest.mark.parametrize("orbits", SETS)
def test_energy_is_that_of_the_whole_set(orbits):
    free = free_points(orbits)
    points = orbits.all_points(free)
    distance = np.linalg.norm(points[:, None] - points[None], axis=-1)
    whole = 0.5 * np.sum(1 / distance[~np.eye(len(points), dtype=bool)])
    order = 2 * len(orbits.group)
    assert designs._energy(free.ravel(), orbits)[0] * order == pytest.approx(whole, rel=1e-12)


def test_unreachable_is_said(monkeypatch):
    monkeypatch.setitem(designs.DESIGN_DEGREE, 8, 7)  # no 8 points are a design of degree 7
    with pytest.raises(RuntimeError, match="M_sph=8: no design of degree 7 from 2 starts"):
        designs.compute_design(8, starts=2)


def test_command_line_writes_files(tmp_path):
    command = [sys.executable, "-W", "error", "-m", "granstudy.quadrature.designs", "6", "12"]
    command += ["--folder", str(tmp_path), "--starts", "1"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["design_3_6.txt", "design_5_12.txt"]
    assert "Residual" in done.stdout
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.loadtxt(tmp_path / "design_5_12.txt").shape == (12, 3)
    text = (tmp_path / "design_3_6.txt").read_text()
    assert "degree 3" in text
    assert "granstudy.quadrature.designs" in text


def test_command_line_names_a_bad_size(capsys):
    with pytest.raises(SystemExit):
        designs.main(["33"])
    assert "M_sph=33: sizes are 2, 6, 12" in capsys.readouterr().err
