"""Densities and laws of users, with their arguments."""

import functools
import multiprocessing
import pickle
from dataclasses import dataclass

import cloudpickle
import dask.base
import numpy as np
import pytest
from own_functions import in_file, in_notebook

import granstudy as gs
from granstudy.model.own_functions import own_density, own_law
from granstudy.support.own_code.load import load_function

X, Y = np.array([[0.5], [1.0]]), np.array([[0.25, 2.0]])


def anisotropic(vx, vy, Tx=1.0, Ty=1.0):
    return np.exp(-(vx**2) / (2 * Tx) - vy**2 / (2 * Ty)) / (2 * np.pi * np.sqrt(Tx * Ty))


def any_dim(*v, T=1.0):
    return np.exp(-sum(vi**2 for vi in v) / T)


def maker(T):
    def density(vx, vy):
        return anisotropic(vx, vy, T, T)

    density.symmetry = "full"
    return density


def whole_gas(T, e=None):
    return gs.Scene(2, maker(T), gs.hard_spheres(2), 0.7, 0.1)


def constant_law(v, kappa, power=0.2):
    return np.clip(1 - kappa * v**power, 0.0, 1.0)


@dataclass
class Law:
    """A law that cannot be hashed."""

    A: float

    def __call__(self, v):
        return np.clip(1 - self.A * v**0.2, 0.0, 1.0)


def density_at(density):
    return density(X, Y).tolist()


def test_a_function_of_the_velocity_with_its_arguments():
    density = own_density(anisotropic, {"Tx": 2.0})
    assert density.dim == 2
    np.testing.assert_array_equal(density(X, Y), anisotropic(X, Y, Tx=2.0))
    assert repr(density) == "anisotropic(Tx=2.0, Ty=1.0)"
    assert density.symmetry == "none" and density.moments is None


def test_equal_content_is_equal():
    same = [
        own_density(anisotropic, {"Tx": 2}),
        own_density(anisotropic, {"Tx": np.float64(2.0), "Ty": 1.0}),
        own_density(functools.partial(anisotropic, Tx=2.0)),
    ]
    assert len({*same}) == 1
    assert own_density(anisotropic, {"Tx": 3.0}) != same[0]
    assert own_density(any_dim, dim=2) != own_density(any_dim, dim=3)
    assert own_law(constant_law, {"kappa": 0.1}) == own_law(constant_law, {"kappa": 0.1})


def test_a_function_without_content_is_itself_alone():
    cell = in_notebook(
        "import numpy as np\nrng = np.random.default_rng()\ndef f(x, y):\n    return rng.normal()"
    )
    one, other = own_density(cell["f"]), own_density(cell["f"])
    assert one == one and one != other


def test_makers_of_densities_and_scenes():
    made = own_density(maker, {"T": 2.0})
    assert (made.dim, made.symmetry, repr(made)) == (2, "full", "maker(T=2.0)")
    np.testing.assert_array_equal(made(X, Y), anisotropic(X, Y, 2.0, 2.0))
    gas = own_density(whole_gas, {"T": 2.0})
    assert gas.dim == 2 and gas.scene.restitution == 0.7
    np.testing.assert_array_equal(gas(X, Y), made(X, Y))
    assert own_density(any_dim, {"T": 2.0}, dim=3).dim == 3
    named = own_density(lambda T: gs.load_scene("maxwellian3d", temperature=T).initial, {"T": 2.0})
    assert named.dim == 3 and named.moments.temperature == 2.0


@pytest.mark.parametrize(
    ("function", "arguments", "dim", "message"),
    [
        (
            anisotropic,
            {"Tz": 1.0},
            None,
            "anisotropic: has no argument 'Tz'; it has vx, vy, Tx, Ty",
        ),
        (anisotropic, {}, 3, "anisotropic: vx, vy have no value; .*the 3 components"),
        (any_dim, {}, None, "any_dim: takes any number of velocity components; give dim"),
        (
            maker,
            {"T": 1.0},
            3,
            "density: vx, vy have no value; .*the 3 components",
        ),
        (maker, {}, None, "maker: T have no value"),
        (lambda T: T, {"T": 1.0}, None, "lambda: returns 1.0; .*must return a density"),
        (lambda T: 1 / T, {"T": 0}, None, r"lambda\(T=0\): ZeroDivisionError: division by zero"),
    ],
)
def test_what_is_no_density(function, arguments, dim, message):
    with pytest.raises(ValueError, match=message):
        own_density(function, arguments, dim)


def test_laws():
    v = np.linspace(0.0, 2.0, 5)
    law = own_law(constant_law, {"kappa": 0.3})
    np.testing.assert_array_equal(law(v), constant_law(v, 0.3))
    assert repr(law) == "constant_law(kappa=0.3, power=0.2)"
    np.testing.assert_array_equal(own_law(Law, {"A": 0.3})(v), law(v))


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (constant_law, {}, "constant_law: argument 'kappa' is missing; of a law the impact speed"),
        (constant_law, {"kapa": 0.1}, "constant_law: has no argument 'kapa' .did you mean 'kappa'"),
        (lambda A: A, {"A": 0.1}, "lambda: returns 0.1; .*must return a law"),
    ],
)
def test_what_is_no_law(function, arguments, message):
    with pytest.raises(ValueError, match=message):
        own_law(function, arguments)


def test_other_processes_get_them(tmp_path):
    in_file(
        tmp_path,
        "def thermal(vx, vy, T=1.0):\n    return vx * vy * T\n\n"
        "def make(T):\n    return lambda x, y: x * y * T\n",
    )
    for name in ("thermal", "make"):
        density = own_density(load_function(f"my_gas.py:{name}", tmp_path), {"T": 3.0})
        assert pickle.loads(pickle.dumps(density)) == density
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            assert pool.apply(density_at, (density,)) == (X * Y * 3.0).tolist()
    law = own_law(constant_law, {"kappa": 0.3})
    assert pickle.loads(pickle.dumps(law)) == law


def test_dask_knows_them_by_content_and_leaves_their_classes_alone(tmp_path):
    in_file(
        tmp_path,
        "from dataclasses import dataclass\n\n@dataclass(frozen=True)\nclass Soft:\n    A: float\n"
        "    def __call__(self, v):\n        return 1 - self.A * v\n",
    )
    law = own_law(load_function("my_gas.py:Soft", tmp_path), {"A": 0.1})
    first = dask.base.tokenize(law)
    assert first == dask.base.tokenize(own_law(law.function, {"A": 0.1}))
    assert first != dask.base.tokenize(own_law(law.function, {"A": 0.2}))
    cloudpickle.loads(cloudpickle.dumps(law.function.own_function))
    assert load_function("my_gas.py:Soft", tmp_path) == law.function
