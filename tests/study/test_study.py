"""Study files: from YAML to a checked list of runs."""

import pytest

from granstudy.collision.choice.methods import maker
from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.runs.estimates import estimate_run
from granstudy.study.run import canonical
from granstudy.study.study import load_study

STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw3d, diffusion: 1.0e-6}
    solver: {R: 7.0, N_rho: 8}
    time: {t_final: 1.0, dt: 0.1}
    sweep:
      - {e: [0.2, 0.80], N: [8], M_sph: [6, 12], method: fast}
    table: {quantity: temperature}
  errors:
    title: errors
    run: collision
    scene: {name: bkw3d, restitution: 0.2}
    solver: {R: 7.0, N_rho: 8, N: 8}
    reference: {method: direct, circular: true}
    sweep:
      - {M_sph: [6, 12], method: literal}
"""


def test_runs_have_canonical_paths(load):
    study = load()
    assert list(study.runs["cooling"]) == [
        f"e~{e}/N~8/M_sph~{M}/method~fast" for e in ("0.2", "0.8") for M in (6, 12)
    ]
    assert [canonical(v) for v in (0.1, 1e-6, 3, [2, 3], "a/b")] == [
        "0.1",
        "0.000001",
        "3",
        "2x3",
        "a%2Fb",
    ]
    run = study.run("cooling", "e~0.8/N~8/M_sph~12/method~fast")
    estimate = estimate_run(run.computation)
    assert (run.scene.restitution, run.solver.M_sph, estimate.evaluations) == (0.8, 12, 30)
    assert estimate.cost.seconds > 0


def test_a_collision_run_has_a_reference_without_directions(load):
    runs = load().runs["errors"]
    assert list(runs) == ["M_sph~6/method~literal", "reference", "M_sph~12/method~literal"]
    reference = runs["reference"].solver
    assert (reference.method, reference.circular) == ("direct", True)
    assert runs["M_sph~6/method~literal"].reference == runs["reference"]


def test_a_value_added_to_a_list_adds_runs_and_changes_none(load):
    before, after = (
        load().runs["cooling"],
        load("M_sph: [6, 12]", "M_sph: [6, 12, 32]").runs["cooling"],
    )
    assert set(before) < set(after)
    for path, run in before.items():
        assert after[path].computation.parameters == run.computation.parameters


def test_tolerances_are_swept_in_place_of_sizes(load):
    sizes = "{e: [0.2, 0.80], N: [8], M_sph: [6, 12], method: fast}"
    study = load(
        f"""solver: {{R: 7.0, N_rho: 8}}
    time: {{t_final: 1.0, dt: 0.1}}
    sweep:
      - {sizes}""",
        """solver: {R: 7.0}
    time: {t_final: 1.0, dt: 0.1}
    sweep:
      - {e: 0.2, rtol: [1.0e-2, 1.0e-4], N: 32}""",
    )
    runs = study.runs["cooling"]
    assert list(runs) == ["e~0.2/N~32/rtol~0.01", "e~0.2/N~32/rtol~0.0001"]
    coarse, fine = runs.values()
    assert (coarse.solver.rtol, maker(coarse.solver)) == (1e-2, AdaptiveOperator)
    assert (
        0
        < estimate_run(coarse.computation).cost.seconds
        < estimate_run(fine.computation).cost.seconds
    )
    assert coarse.computation.parameters != fine.computation.parameters


def test_a_run_outside_the_study(load):
    with pytest.raises(ValueError, match="study 'test' has no run cooling/e~0.3"):
        load().run("cooling", "e~0.3")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("title: test", "titel: test", "titel: unknown field .did you mean 'title'"),
        (
            "run: evolution",
            "rnu: evolution",
            "experiments.cooling.rnu: unknown field .did you mean",
        ),
        ("diffusion: 1.0e-6", "epsilom: 1", "scene.epsilom: unknown field .did you mean 'epsilon'"),
        ("N_rho: 8}", "N_roh: 8}", "solver.N_roh: unknown field .did you mean 'N_rho'"),
        ("t_final: 1", "t_finl: 1", "time.t_finl: unknown field .did you mean 't_final'"),
        ("quantity: ", "quantitiy: ", "table.quantitiy: unknown field .did you mean 'quantity'"),
        ("e: [0.2", "epsilo: [0.2", "sweep: unknown parameter 'epsilo' .did you mean 'epsilon'"),
        (
            "1.0e-6",
            "1e-6",
            "value '1e-6': must be a number .YAML reads 1e-6 as text: write 1.0e-6",
        ),
        ("t_final: 1.0", "t_final: [1.0]", r"time.t_final: value \[1.0\]"),
        ("N: [8]", "N: [-8]", "run e~0.2/N~-8.*N=-8: must be an even integer"),
        ("M_sph: [6, 12], method: fast", "M_sph: [6, 33], method: fast", "M_sph=33: rule 'design'"),
        ("e: [0.2", "e: [1.2", "e=1.2: must be a number between 0 and 1"),
        ("name: bkw3d", "name: bkv3d", "unknown scene 'bkv3d' .did you mean 'bkw3d'"),
        ("method: fast", "method: fats", "unknown method 'fats' .did you mean 'fast'"),
        ("R: 7.0, N_rho: 8}", "N_rho: 8}", "R: set solver.R or sweep R"),
        (", dt: 0.1", "", "dt: set time.dt or sweep dt"),
        ("dt: 0.1", "dt: 0.3", "must be a whole number of steps"),
        ("    time: {t_final: 1.0, dt: 0.1}\n", "", "time: evolution runs need it"),
        ("title: cooling", "title: [cooling", "not YAML"),
    ],
)
def test_mistakes_name_file_field_value_and_what_is_allowed(load, old, new, message):
    with pytest.raises(ValueError, match=message) as error:
        load(old, new)
    assert "test.yaml" in str(error.value)


@pytest.mark.parametrize("path", ["nowhere.yaml", ".", "a\0b"])
def test_no_such_file(path):
    with pytest.raises(ValueError, match="no such file"):
        load_study(path)


def test_names_of_files_that_are_too_long_are_told_as_others_are(load):
    with pytest.raises(ValueError, match="study 'xxx.*File name too long"):
        load_study("x" * 300)
    with pytest.raises(ValueError, match="experiments.cooling.*File name too long"):
        load("N_rho: 8}", f"N_rho: 8, sphere_rule: {'x' * 300}}}")
