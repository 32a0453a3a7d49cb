"""What thousands of runs have in common is computed once."""

import ast
from collections import Counter

import numpy as np
import pytest

import granstudy as gs
from granstudy.model import isotropy
from granstudy.support import fingerprint
from granstudy.velocity import symmetry

STUDY = """
title: t
experiments:
  cooling:
    title: t
    run: evolution
    scene: {name: maxwellian3d, temperature: 1.0}
    solver: {N: 16, R: 7.0, method: radial}
    time: {t_final: 3.0, dt: 0.02}
    sweep:
      - e: [0.5, 0.6, 0.7, 0.8, 0.9]
        exponent: [0.0, 0.25, 0.5, 0.75, 1.0]
        diffusion: [0.0, 0.001]
"""


@pytest.fixture
def calls(monkeypatch):
    """Counts of what is expensive, from empty caches on."""
    made = Counter()

    def count(owner, name, key):
        inner = getattr(owner, name)

        def counted(*args, **more):
            made[key(*args)] += 1
            return inner(*args, **more)

        monkeypatch.setattr(owner, name, counted)

    for kept in (
        symmetry._generated,
        symmetry._stabiliser,
        isotropy._check_named,
        fingerprint._code,
        fingerprint._fingerprint,
    ):
        kept.cache_clear()
    count(symmetry, "_closure", lambda dim, elements: ("group", tuple(elements)))
    count(ast, "parse", lambda source: ("source", source))
    count(isotropy, "directions", lambda dim: ("directions", dim))
    return made


def test_it_is_computed_once(load, calls):
    study = load()
    assert len({member.key for member in study.members}) == 50
    assert {what for what, _ in calls} == {"group", "source", "directions"}
    assert set(calls.values()) == {1}


def test_a_function_is_checked_each_time_as_it_may_have_changed():
    centre = [0.0]
    scene = gs.Scene(2, lambda x, y: np.exp(-((x - centre[0]) ** 2) - y**2), gs.maxwell(2))
    isotropy.check_isotropic(scene, 5.0)
    centre[0] = 1.0
    with pytest.raises(ValueError, match="isotropic about v = 0"):
        isotropy.check_isotropic(scene, 5.0)
