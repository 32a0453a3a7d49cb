"""Which parameters of a function are velocities, and which are arguments."""

import pytest

from granstudy.support.own_code.signature import (
    REQUIRED,
    arguments_of,
    dimension,
    parameters_left,
)


def plane(vx, vy, T=1.0, *, n=2):
    return vx


def space(x, y, z, T):
    return x


def many(*v, T=1.0):
    return v


def made(T):
    return lambda x, y: T


def left_of(function, **arguments):
    return parameters_left(function, arguments).open


def test_arguments_with_their_defaults():
    assert arguments_of(plane) == {"vx": REQUIRED, "vy": REQUIRED, "T": 1.0, "n": 2}
    assert arguments_of(many) == {"T": 1.0}


def test_what_has_no_value_is_a_velocity():
    assert left_of(plane) == left_of(plane, T=2.0, n=3) == ("vx", "vy")
    assert left_of(space, T=2.0) == ("x", "y", "z")
    assert left_of(made, T=1.0) == left_of(many) == ()
    assert dimension(plane, parameters_left(plane, {}), None) == 2
    assert dimension(space, parameters_left(space, {"T": 1}), 3) == 3
    assert dimension(many, parameters_left(many, {}), 3) == 3


@pytest.mark.parametrize(
    ("function", "arguments", "dim", "message"),
    [
        (
            plane,
            {"TT": 1},
            None,
            "plane: has no argument 'TT' .did you mean 'T'.*; it has vx, vy, T, n",
        ),
        (space, {}, None, "space: x, y, z, T have no value; .*the 2 or 3 components"),
        (space, {"x": 1.0, "T": 1.0}, None, "space: argument 'y' is missing; .*must come first"),
        (plane, {}, 3, "plane: vx, vy have no value; .*the 3 components"),
        (many, {}, None, "many: takes any number of velocity components; give dim, 2 or 3"),
        (lambda v, *, k: v, {}, None, "lambda: argument 'k' is missing"),
        (lambda v: v, {}, None, "lambda: v have no value; of a density the 2 or 3"),
        (dict, {}, None, "dict: its arguments are not known"),
    ],
)
def test_what_does_not_fit(function, arguments, dim, message):
    with pytest.raises(ValueError, match=message):
        dimension(function, parameters_left(function, arguments), dim)
