"""Random runs: what is drawn, what each is held against, and a few of them whole.

The study ``studies/labels.yaml`` makes a thousand; here are few and cheap ones.
"""

from collections import Counter

import numpy as np
import pytest

from granstudy.model.densities import scene_names
from granstudy.model.methods import METHODS
from granstudy.runs.computation import Computation
from granstudy.runs.estimates import estimate_run
from granstudy.runs.execute import execute
from granstudy.runs.labels.cases import random_case
from granstudy.runs.labels.truths import truth_of
from granstudy.runs.run_key import code_of_run, run_key
from granstudy.study.checks import check_computation
from granstudy.trust.flags import Trust
from granstudy.trust.rules import Judged
from granstudy.trust.truth import Errors

DRAWN = range(400)
"""Seeds of runs that are drawn, and not made."""

CHEAP = 0.25
"""Estimated seconds of a run and its truth that are made here, at most."""

MADE = 32
"""How many are made."""


def computation(seed):
    case = random_case(seed)
    return Computation("labels", case.scene, case.solver, case.time)


@pytest.fixture(scope="module")
def drawn():
    return {seed: computation(seed) for seed in DRAWN}


def outcome(run):
    ds = execute(run, threads=1)
    pairs = [
        Errors(*(float(ds[name.format(x)]) for x in Errors._fields))
        for name in ("largest_{}_error", "{}_error_estimate", "{}_known_to")
    ]
    by_particles = run.solver.traits.by_particles
    return Judged(Trust(int(ds["trust"])), bool(ds["ended"]), *pairs, by_particles)


def test_no_rule_is_broken_and_every_label_is_given(drawn):
    cheap = [seed for seed, run in drawn.items() if estimate_run(run).cost.seconds < CHEAP][:MADE]
    found = {seed: outcome(drawn[seed]) for seed in cheap}
    assert {seed: str(one) for seed, one in found.items() if one.broken} == {}
    assert {one.trust for one in found.values()} == set(Trust)
    assert len(found) == MADE


def test_every_run_can_be_computed(drawn):
    for run in drawn.values():
        check_computation(run)


def test_a_seed_is_always_the_same_run(drawn):
    for seed in (0, 7, 43):
        assert computation(seed).parameters == drawn[seed].parameters
    assert len({run.parameters for run in drawn.values()}) == len(drawn)


def test_all_kinds_of_gases_and_runs_occur(drawn):
    runs = list(drawn.values())
    on_grids = [run.time for run in runs if not run.solver.traits.by_particles]
    drawn_scenes = {run.scene.coordinates()["scene"] for run in runs}
    assert drawn_scenes == {*scene_names(), "Gaussians", "StatedGaussians"}
    for dim in (2, 3):
        assert {run.solver.method for run in runs if run.scene.dim == dim} == set(METHODS)
    assert {time.frame for time in on_grids} == {"fixed", "rescaled"}
    assert {time.scheme for time in on_grids} == {"rk3", "dopri54", "exponential"}
    assert {time.dt is None for time in on_grids} == {True, False}
    assert len({time.conserve for time in on_grids}) == 5
    assert {run.scene.kernel.exponent for run in runs} == {0.0, 0.5, 1.0}
    assert any(callable(run.scene.restitution) for run in runs)
    assert Counter(run.scene.diffusion == 0.0 for run in runs).keys() == {True, False}


def test_the_truth_is_the_law_or_a_run_at_the_same_times(drawn):
    for run in drawn.values():
        truth = truth_of(run)
        maxwell = run.scene.kernel.exponent == 0.0 and not callable(run.scene.restitution)
        assert (truth is None) == maxwell
        if truth is not None:
            assert truth.solver.traits.by_particles or truth.solver.N >= 48
            recorded = truth.time.recorded
            assert all(np.isclose(recorded, t).any() for t in run.time.recorded)


def test_its_key_follows_the_code_of_its_truth(drawn):
    carleman = next(
        run
        for run in drawn.values()
        if run.solver.method == "carleman" and run.scene.kernel.exponent == 1.0
    )
    code = code_of_run(carleman)
    truth = truth_of(carleman)
    assert set(code_of_run(truth)) < set(code)
    assert any("carleman" in module for module in code)
    own = Computation("evolution", carleman.scene, carleman.solver, carleman.time_fields)
    assert run_key(own) != run_key(carleman)


def test_its_cost_is_that_of_run_and_truth(drawn):
    estimate_run.cache_clear()  # a tensor that another test made costs nothing any more
    run = next(run for run in drawn.values() if truth_of(run) is not None)
    own = Computation("evolution", run.scene, run.solver, run.time_fields)
    parts = estimate_run(own).cost.seconds + estimate_run(truth_of(run)).cost.seconds
    assert estimate_run(run).cost.seconds == pytest.approx(parts)
