"""Values that a careless or a malicious caller may give."""

from typing import Any

import numpy as np
from hypothesis import strategies as st


def gaussian(x, y):
    return np.exp(-(x**2 + y**2) / 2) / (2 * np.pi)


def of_values(values):
    def density(vx, vy):
        return values(vx + 0.0 * vy)

    return density


def raises(error):
    def fails(*given):
        raise error

    return fails


ANSWERS = [
    lambda x: x,
    lambda x: x * np.nan,
    lambda x: x * 1j,
    lambda x: 0.0 * x,
    lambda x: -np.exp(-(x**2)),
    lambda x: 1e300 * np.exp(-(x**2)),
    lambda x: 1e-300 * np.exp(-(x**2)),
    lambda x: np.exp(-(x**2))[..., :1],
    lambda x: np.exp(-(x**2))[np.newaxis],
    lambda x: np.exp(-(x**2)) > 0.5,
    lambda x: np.exp(-(x**2)).astype(object),
    lambda x: np.exp(-(x**2)).astype(str),
    lambda x: np.exp(-(x**2)).astype(np.float16),
    lambda x: np.exp(-(x**2)).tolist(),
    lambda x: 0.5,
    lambda x: np.float64(0.5),
    lambda x: np.array(0.5),
    lambda x: "text",
    lambda x: None,
    lambda x: [],
    lambda x: {},
    lambda x: lambda y: y,
    lambda x: [1.0, [2.0, 3.0]],
]
"""What a density or a law may return, given the first velocity component or the impact speed."""

FAILURES = [
    ValueError("on purpose"),
    RuntimeError("on purpose"),
    TypeError("on purpose"),
    KeyError("on purpose"),
    ZeroDivisionError("on purpose"),
]

DENSITIES = [
    *map(of_values, ANSWERS),
    *map(raises, FAILURES),
    lambda: 0.5,
    lambda x: x,
    lambda x, y, z, w: x,
    lambda x, y=1.0: np.exp(-(x**2)),
    np.sin,
    abs,
    dict,
]
LAWS = [*ANSWERS, *map(raises, FAILURES), lambda: 0.5, lambda a, b: a, np.sin, abs, dict]

NUMBERS = [
    *(0, 1, 2, 3, 4, 8, 16, 33, -1, 10**5, 10**9, 10**18, 10**400, -(10**400)),
    *(0.0, -0.0, 0.5, 1.0, 2.5, 7.0, -0.5, 1e-300, 1e300, 5e-324, np.inf, -np.inf, np.nan),
    *(np.int64(8), np.int8(3), np.uint8(200), np.float32(0.5), np.float64(0.5), np.float16(6.5)),
    *(np.array(0.5), np.array(8), np.array([0.5]), np.longdouble(0.5), np.bool_(True)),
    *(True, False, 0.5j, 1 + 0j, np.complex128(0.5)),
]
OTHERS = [
    *(None, "", "x", "0.5", "8", "é\n", "x" * 300, "../x", "a.py:f", b"x", "\0"),
    *([], [0.5], (), (1,), (2, 3), (0.0, 1.0), [1, [2]], {}, {"a": 1}, set(), range(3)),
    *(np.array([1.0, np.nan]), np.zeros((2, 2)), np.zeros(0), np.array(["a"]), np.array(None)),
    *(object(), int, ValueError("x"), lambda: 0, ...),
]
WORDS = [
    *("fast", "radial", "direct", "literal", "carleman", "dsmc", "auto", "full", "separate"),
    *("lebedev", "product", "gauss-theta-phi", "design", "single", "double", "gpu", "cpu"),
    *("none", "inversion", "exchange", "reflections", "rescaled", "fixed", "rk3", "dopri54"),
    *(
        "exponential",
        "mass",
        "energy",
        "maxwellian2d",
        "bkw3d",
        "three_gaussians3d",
        "viscoelastic",
    ),
    *(("mass",), ("energy", "mass"), ["mass", "mass"], ("mass", 1), "jacobi", "legendre"),
]


def odd(*more: Any) -> st.SearchStrategy[Any]:
    """Values that a careless or a malicious caller may give, and ``more`` of a field's own."""
    listed = st.sampled_from([*NUMBERS, *OTHERS, *WORDS])
    drawn = st.one_of(st.floats(), st.integers(), st.text(max_size=5))
    own = [st.sampled_from(more)] * (6 if more else 0)
    return st.one_of(listed, listed, drawn, *own)


ARRAYS = [
    *(np.zeros((8, 8)), np.full((8, 8), np.nan), np.ones((8, 8), complex), np.ones((8, 7))),
    *(np.ones((8, 8), int), np.ones((8, 8), object), np.full((8, 8), "a"), np.ones((8,) * 3)),
    *(np.full((8, 8), -1.0), np.ones((8, 8), "f4"), np.ones((8, 8), bool)),
    *(np.full((8, 8), 1e-200), np.ones((8, 8)).tolist(), np.ones((8, 8), np.longdouble)),
    *(np.ones((8, 8), ">f8"), np.ones((8, 16))[:, ::2], np.full((8, 8), np.inf), np.ones(8)),
]
