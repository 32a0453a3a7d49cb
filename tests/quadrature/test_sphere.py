"""Sphere rules: exact to the stated degree and no further, and what wrong input gets."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import lebedev_rule
from scipy.spatial.transform import Rotation

from granstudy.quadrature import exact_degree, residual, sphere_rule, sphere_sizes
from granstudy.quadrature.sphere import LEBEDEV_DEGREE

RULES = [
    *[(M, "design") for M in sphere_sizes("design")],
    *[(M, "lebedev") for M in sphere_sizes("lebedev")[:20]],
    *[(M, "product") for M in sphere_sizes("product")[:12]],
]
FILE = "unit_vectors.txt"


@pytest.mark.parametrize(("M_sph", "rule"), RULES)
def test_exact_to_its_degree_and_no_further(M_sph, rule):
    sphere = sphere_rule(M_sph, rule)
    assert sphere.points.shape == (M_sph, 3)
    assert sphere.weights.sum() == pytest.approx(4 * np.pi, rel=1e-13)
    assert sphere.antipodal
    assert residual(sphere.points, sphere.degree, sphere.weights) < 1e-13
    # all of these are antipodal, so that the odd degree and only it is exact
    assert exact_degree(sphere.points, sphere.weights) == sphere.degree
    assert residual(sphere.points, sphere.degree + 1, sphere.weights) > 1e-3


@pytest.mark.parametrize("rule", ["design", "lebedev", "product"])
@given(seed=st.integers(0, 2**32 - 1), index=st.integers(0, 9))
def test_random_polynomials_are_integrated_exactly_whatever_the_orientation(rule, seed, index):
    sphere = sphere_rule(sphere_sizes(rule)[index], rule)
    rng = np.random.default_rng(seed)
    points = sphere.points @ Rotation.random(rng=rng).as_matrix()
    # (a·x)^p: 4π/(p + 1) |a|^p for even p, else 0; these span all polynomials of degree p
    a = rng.normal(size=3)
    a /= np.linalg.norm(a)
    for p in (sphere.degree - 1, sphere.degree):
        exact = 4 * np.pi / (p + 1) if p % 2 == 0 else 0.0
        assert sphere.weights @ (points @ a) ** p == pytest.approx(exact, abs=2e-13)


def plane_wave_error(M_sph, rule: str, k: float) -> float:
    """Largest error of ∫ e^{ik·x} dω = 4π sin k / k over a few directions of k."""
    sphere = sphere_rule(M_sph, rule)
    directions = np.random.default_rng(1).normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    waves = sphere.weights @ np.exp(1j * k * sphere.points @ directions.T)
    return np.abs(waves - 4 * np.pi * np.sinc(k / np.pi)).max()


@pytest.mark.parametrize(
    ("rule", "sizes"),
    [
        ("design", (12, 48, 94, 192)),
        ("lebedev", (14, 50, 86, 194)),
        ("product", (18, 50, 98, 200)),
    ],
)
def test_plane_waves_converge_spectrally(rule, sizes):
    # the first missed degree t + 1 enters with j_{t+1}(k), super-exponentially small for t > k
    errors = np.array([plane_wave_error(M, rule, 4.0) for M in sizes])
    assert np.all(errors[1:] < errors[:-1] / 20), errors
    assert errors[-1] < 1e-7, errors


def test_the_papers_gauss_rule_converges_and_is_poor():
    pairs = (6, 8), (12, 16), (24, 32)
    errors = [plane_wave_error(pair, "gauss-theta-phi", 4.0) for pair in pairs]
    assert errors[0] > errors[1] > errors[2], errors
    assert errors[2] < 1e-9, errors
    assert errors[1] > 1e3 * plane_wave_error(192, "design", 4.0), errors  # of as many points


def test_gauss_theta_phi_is_the_plain_product_in_theta_and_phi():
    rule = sphere_rule((2, 3), "gauss-theta-phi")
    theta = np.pi / 2 * (1 + np.array([-1, 1]) / np.sqrt(3))
    assert rule.points.shape == (6, 3)
    np.testing.assert_allclose(rule.points[::3, 2], np.cos(theta), rtol=1e-14)
    np.testing.assert_allclose(rule.weights.sum(), np.pi**2 * np.sin(theta).sum(), rtol=1e-14)
    assert rule.degree == -1
    assert not rule.antipodal
    total = sphere_rule((16, 5), "gauss-theta-phi").weights.sum()
    assert total == pytest.approx(4 * np.pi, rel=1e-14)


def test_small_designs_are_the_polyhedra():
    octahedron = np.vstack([np.eye(3), -np.eye(3)])
    points = sphere_rule(6).points
    distance = np.linalg.norm(octahedron[:, None] - points[None], axis=-1)
    assert distance.min(axis=1).max() < 1e-15
    icosahedron = sphere_rule(12).points
    cosines = np.sort(icosahedron @ icosahedron.T, axis=1)
    expected = np.array([-1, *[-1 / np.sqrt(5)] * 5, *[1 / np.sqrt(5)] * 5, 1])
    np.testing.assert_allclose(cosines, np.tile(expected, (12, 1)), atol=1e-15)


def test_lebedev_table_is_scipys():
    for M_sph, degree in LEBEDEV_DEGREE.items():
        assert lebedev_rule(degree)[0].shape == (3, M_sph)


def test_product_weights_are_positive_and_lebedevs_known_exceptions_are_not():
    assert all(np.all(sphere_rule(M, "product").weights > 0) for M in (2, 18, 200))
    negative = [M for M in LEBEDEV_DEGREE if np.any(sphere_rule(M, "lebedev").weights < 0)]
    assert negative == [74, 230, 266]


def test_largest_product_rule_is_accurate():
    M_sph = sphere_sizes("product")[-1]
    rule = sphere_rule(M_sph, "product")
    assert rule.degree == 127
    assert np.abs(rule.weights @ np.exp(30j * rule.points[:, 0]) / (4 * np.pi)
                  - np.sin(30) / 30) < 1e-14  # fmt: skip


@pytest.fixture
def unit_vectors(tmp_path):
    """A file of the icosahedron, turned."""
    path = tmp_path / FILE
    turned = sphere_rule(12).points @ Rotation.from_euler("xyz", [0.1, 0.2, 0.3]).as_matrix()
    np.savetxt(path, turned, fmt="%.17g", header="an icosahedron")
    return path


def test_a_file_is_read_and_its_degree_measured(unit_vectors):
    for given_path in (unit_vectors, str(unit_vectors)):
        rule = sphere_rule(12, given_path)
        assert (len(rule), rule.degree, rule.antipodal, rule.name) == (12, 5, True, FILE)
    assert len(sphere_rule(None, unit_vectors)) == 12
    np.savetxt(unit_vectors, sphere_rule(None, unit_vectors).points[:5], fmt="%.17g")
    assert sphere_rule(5, unit_vectors).degree == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            b"1 0 0\n# x\n0 1.00001 0 # y\n",
            ", line 3: '0 1.00001 0' has a length off 1 by 1.0e-05; must be a unit vector within 1e-12",
        ),
        (b"1 0\n0 1\n", ", line 1: '1 0' must be three finite numbers"),
        (b"1 0 0\n\n0 nan 0\n", ", line 3: '0 nan 0' must be three finite numbers"),
        (b"1 0 0\n0 1\n", ", line 2: '0 1' must be three finite numbers"),
        (b"x y z\n", ", line 1: 'x y z' must be three finite numbers"),
        (b"# nothing\n\n", ": has no line with a unit vector"),
        (b"", ": has no line with a unit vector"),
        (b"0 " * 1000, ", line 1: '" + "0 " * 40 + "...' must be three finite numbers"),
        (b"\xff\xfe1", ": cannot be read as text"),
    ],
)
def test_a_bad_file_and_its_line_are_named(tmp_path, text, message):
    path = tmp_path / FILE
    path.write_bytes(text)
    with pytest.raises(ValueError, match=re.escape(message)) as raised:
        sphere_rule(None, path)
    assert str(raised.value).startswith(f"sphere_rule={str(path)!r}")


@pytest.mark.parametrize(
    ("M_sph", "message"),
    [
        ((100000, 100000), "N_theta * N_phi=10000000000: at most 65536"),
        ((5000, 1), "N_theta=5000: at most 4096; the nodes are eigenvalues"),
    ],
)
def test_sizes_that_no_machine_needs_are_refused_before_they_are_made(M_sph, message):
    with pytest.raises(ValueError, match=re.escape(f"M_sph={M_sph}: {message}")):
        sphere_rule(M_sph, "gauss-theta-phi")


@pytest.mark.parametrize("M_sph", [11, 12.0, True, (12, 1)])
def test_a_file_of_another_size_is_named(unit_vectors, M_sph):
    with pytest.raises(ValueError, match=re.escape(f"M_sph={M_sph!r}: ") + ".* has 12 points"):
        sphere_rule(M_sph, unit_vectors)


@pytest.mark.parametrize(
    ("M_sph", "rule", "message"),
    [
        (33, "design", "M_sph=33: rule 'design' has sizes 2, 6, 12, 32, 48, 70, 94, 120, 156, 192;"
                       " nearest 32"),
        (22, "design", "nearest 12 or 32"),
        (10**9, "design", "nearest 192"),
        (32.0, "design", "M_sph=32.0: rule 'design'"),
        (True, "design", "M_sph=True: rule 'design'"),
        (None, "design", "M_sph=None: rule 'design'"),
        ((6, 8), "design", "M_sph=(6, 8): rule 'design'"),
        (32, "lebedev", "M_sph=32: rule 'lebedev' has sizes 6, 14, 26, 38, 50, 74, 86, 110, 146,"
                        " 170, 194, 230, ...; nearest 26 or 38"),
        (100, "product", "M_sph=100: rule 'product' has sizes 2, 8, 18, 32, 50, 72, 98, 128, 162,"
                         " 200, 242, 288, ...; nearest 98"),
        (48, "gauss-theta-phi", "M_sph=48: rule 'gauss-theta-phi' takes a pair (N_theta, N_phi)"),
        ((6, 0), "gauss-theta-phi", "M_sph=(6, 0): rule 'gauss-theta-phi' takes a pair"),
        (32, "desing", "unknown sphere_rule 'desing' (did you mean 'design'?)"),
        (32, "no/such/file.txt", "unknown sphere_rule 'no/such/file.txt': allowed are design, "
                                 "lebedev, product, gauss-theta-phi, path of a text file"),
    ],
)  # fmt: skip
def test_bad_input_is_named(M_sph, rule, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        sphere_rule(M_sph, rule)


def test_sizes_of_an_unknown_rule():
    assert sphere_sizes("gauss-theta-phi") == ()
    with pytest.raises(
        ValueError, match=r"unknown sphere_rule 'Design' \(did you mean 'design'\?\)"
    ):
        sphere_sizes("Design")


def test_numpy_integers_and_lists_are_sizes():
    assert len(sphere_rule(np.int64(32))) == 32
    assert len(sphere_rule([2, 3], "gauss-theta-phi")) == 6
