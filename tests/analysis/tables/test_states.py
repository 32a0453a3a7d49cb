"""States in a study: their runs, their table beside theory and other experiments, their figure."""

import json
import shutil

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.analysis.figures.figure import draw
from granstudy.analysis.figures.states import NOT_TRUSTED, UNIT
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.plan import study_forecasts
from granstudy.analysis.tables.table import csv_table, experiment_table, write_table
from granstudy.study.execute import execute
from granstudy.study.run_key import run_fingerprint, run_key
from granstudy.study.study import load_study
from granstudy.support import fingerprint as module
from granstudy.trust.flags import Trust

STUDY = """
title: states
experiments:
  cooling:
    title: cooling
    run: state
    state: cooling
    scene: {name: maxwellian3d, exponent: 1.0, epsilon: 0.0}
    solver: {N: 24, R: 9.0, method: radial}
    sweep:
      - {e: [0.6, 0.8]}
    table: {quantity: a2, beside: [particles]}
    figure: {kind: states}
  particles:
    title: particles
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, epsilon: 0.0}
    solver: {N: 16, R: 7.0, method: dsmc, particles: 2000, batches: 10}
    time: {t_final: 40.0, time_rtol: 1.0e-6, times: {first: 10.0, per_decade: 20}}
    sweep:
      - {e: [0.8, 0.9]}
    table: {quantity: a2, average: {start: 10.0}}
  maxwell:
    title: maxwell
    run: state
    state: heated
    scene: {name: maxwellian2d, exponent: 0.0, epsilon: 0.1}
    solver: {method: radial}
    sweep:
      - {e: [0.7, 0.9], N: 14, R: 8.0}
      - {e: [0.7, 0.9], N: 24, R: 9.0}
    table: {quantity: a2_error}
    figure: {kind: states}
  marching:
    title: marching
    run: evolution
    scene: {name: maxwellian2d, exponent: 0.0, epsilon: 0.06375}
    solver: {N: 24, R: 9.0, method: radial}
    time: {t_final: 150.0, time_rtol: 1.0e-8}
    sweep:
      - {e: 0.7}
    table: {quantity: a2}
  direct:
    title: direct
    run: state
    state: heated
    scene: {name: maxwellian2d, exponent: 0.0, epsilon: 0.06375}
    solver: {N: 40, R: 9.0, method: auto}
    sweep:
      - {e: 0.7}
    table: {quantity: a2, beside: [marching]}
"""

BESIDE = {"cooling": ["particles"], "direct": ["marching"]}


def load(path, old="", new=""):
    assert old in STUDY
    path.write_text(STUDY.replace(old, new, 1) if old else STUDY)
    return load_study(path)


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """Every experiment's table, and its files."""
    folder = tmp_path_factory.mktemp("states")
    study = load(folder / "states.yaml")
    files, found = {}, {}
    for name in ("particles", "marching", "cooling", "maxwell", "direct"):
        files[name] = []
        for path, run in study.runs[name].items():
            files[name].append(str(folder / name / f"{path}.nc"))
            gs.write_dataset(execute(run, threads=1), files[name][-1], duration=1.0)
        others = [found[other] for other in BESIDE.get(name, [])]
        experiment = study.model.experiments[name]
        found[name] = experiment_table(experiment, study.runs[name], files[name], others)
    return study, files, found


def test_a_run_is_the_state_that_python_finds(tables):
    study, files, found = tables
    run = study.run("cooling", "e~0.8")
    state = gs.cooling_state(run.scene, run.solver)
    for name in ("a2", "a3", "cooling_coefficient"):
        assert float(found["cooling"][name][1]) == float(state[name])
    assert gs.read_dataset(files["cooling"][1]).attrs["title"] == "granstudy cooling state"
    assert found["cooling"]["trust"].values[1] == Trust.TRUSTED
    # opened together, as any runs
    last = gs.unstack_runs(gs.final_values(files["cooling"]))
    assert float(last["a2"].sel(e=0.8)) == float(state["a2"])


def test_theory_stands_beside(tables):
    _, _, found = tables
    hard = found["cooling"]
    for i, e in enumerate((0.6, 0.8)):
        assert float(hard["a2_linear"][i]) == theory.cooling_state_a2(e)
        assert float(hard["a2_divided"][i]) == theory.montanero_santos_a2(e)
    maxwell = found["maxwell"]
    exact = theory.maxwell_heated_moments(2, 0.7, 2)[2] - 1.0
    assert float(maxwell["a2_exact"][0]) == pytest.approx(exact)
    error = np.abs(maxwell["a2"] - maxwell["a2_exact"])
    np.testing.assert_allclose(maxwell["a2_error"], error)
    assert np.all(error[2:].values < 1e-4) and "tail_exponent" not in maxwell


def test_particles_stand_beside_the_same_gases(tables):
    """At the one e that both sweep, within their errors; at others there is no number."""
    _, _, found = tables
    table, particles = found["cooling"], found["particles"]
    assert np.isnan(table["a2_particles"][0])
    assert float(table["a2_particles"][1]) == float(particles["a2"][0])
    difference = float(table["a2_particles_difference"][1])
    assert difference == pytest.approx(float(particles["a2"][0] - table["a2"][1]))
    assert abs(difference) < 4 * float(table["a2_particles_standard_error"][1])
    assert "temperature_particles" not in table


def test_marching_and_solving_come_to_the_same_heated_state(tables):
    table = tables[2]["direct"]
    for name in ("a2", "temperature"):
        assert abs(float(table[f"{name}_marching_difference"][0])) < 1e-6
    assert "a2_marching_standard_error" not in table


def test_tables_are_written(tables, tmp_path):
    table = tables[2]["cooling"]
    write_table(table, *(tmp_path / f"cooling.{kind}" for kind in ("nc", "csv", "md")))
    assert gs.read_dataset(tmp_path / "cooling.nc").attrs["state"] == "cooling"
    header, _, second = csv_table(table).splitlines()
    assert header.startswith("e,a2,a2_linear,a2_divided,a2_particles,")
    assert second.split(",")[0] == "0.8" and "trusted" in second
    assert f"| {float(table['a2'][1]):.6f} |" in markdown_table(table)


def test_a_figure_shows_table_and_theory(tables):
    study, _, found = tables
    upper, lower = draw(study.model.experiments["cooling"], found["cooling"], []).axes
    lines = {line.get_label(): line for line in upper.lines}
    np.testing.assert_array_equal(lines["solved for"].get_ydata(), found["cooling"]["a2"])
    curve = lines["linear theory (van Noije & Ernst)"]
    e = curve.get_xdata()[40]
    assert curve.get_ydata()[40] == pytest.approx(theory.cooling_state_a2(e))
    (bars,) = lower.containers
    segment = bars.lines[2][0].get_segments()[1]
    width = 4 * float(found["cooling"]["a2_particles_standard_error"][1]) / UNIT
    assert segment[1, 1] - segment[0, 1] == pytest.approx(width)
    upper, lower = draw(study.model.experiments["maxwell"], found["maxwell"], []).axes
    assert lower.get_yscale() == "log"
    coarse = next(line for line in lower.lines if line.get_label() == "$N$ = 14, $R$ = 8")
    np.testing.assert_array_equal(coarse.get_ydata(), found["maxwell"]["a2_error"][:2])
    untrusted = [line for line in upper.lines if line.get_label() == NOT_TRUSTED]
    assert bool(untrusted) == bool(np.any(found["maxwell"]["trust"] != Trust.TRUSTED))


def test_a_figure_needs_states(tables):
    study, _, found = tables
    with pytest.raises(ValueError, match="particles: is no table of states swept over e"):
        draw(study.model.experiments["cooling"], found["particles"], [])


def test_what_a_state_will_take(tables):
    """The solver of an isotropic state is chosen for it, and its evaluations of Q are counted."""
    study, files, _ = tables
    (run,) = study.runs["direct"].values()
    assert run.choice.solver.method == "radial"
    chosen = json.loads(gs.read_dataset(files["direct"][0]).attrs["solver"])
    assert chosen["N"] == run.choice.solver.N
    forecast = dict(study_forecasts(study))["direct/e~0.7"]
    assert forecast.evaluations == run.evaluations > 2 * chosen["N"]
    assert forecast.seconds > run.evaluations * forecast.seconds_per_evaluation
    assert run.cost.evaluations == run.evaluations


def test_keys_of_states_are_their_own(tables, tmp_path):
    study = tables[0]
    run = study.run("cooling", "e~0.8")
    assert json.loads(run.parameters())["run"] == "cooling state"
    assert run_key(run) != run_key(study.run("cooling", "e~0.6"))


def test_an_edit_of_newtons_method_changes_states_alone(tmp_path, monkeypatch):
    copy = tmp_path / "granstudy"
    shutil.copytree(module.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))

    def prints():
        module.imported_modules.cache_clear()
        module._tree.cache_clear()
        return {kind: run_fingerprint(kind, "radial") for kind in ("state", "evolution")}

    before = prints()
    monkeypatch.setattr(module, "PACKAGE", copy)
    path = copy / "states" / "newton.py"
    path.write_text(path.read_text().replace("DENSE = 256", "DENSE = 200"))
    after = prints()
    assert {kind for kind in after if after[kind] != before[kind]} == {"state"}
    module.imported_modules.cache_clear()
    module._tree.cache_clear()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("    state: cooling\n", "", "state: state runs need it, cooling or heated"),
        ("state: cooling", "state: coling", "experiments.cooling.state: value 'coling'"),
        ("{e: [0.6, 0.8]}", "{e: [0.6], dt: 0.1}", "sweep: 'dt' is of times, which only evolution"),
        ("{e: [0.6, 0.8]}", "{e: [0.6, 1.0]}", "restitution=1.0: must be below 1"),
        ("{e: [0.6, 0.8]}", "{e: 0.6, epsilon: 0.1}", "diffusion=0.1: a cooling state has none"),
        ("method: radial}", "method: dsmc, particles: 1000}", "particles have no equation"),
        (
            "beside: [particles]",
            "beside: [partices]",
            "table.beside: unknown experiment 'partices'",
        ),
        ("average: {start: 10.0}", "beside: [cooling]", "table.beside: only state runs take it"),
        ("average: {start: 10.0}", "average: {stat: 10.0}", "unknown field .did you mean 'start'"),
        (
            "{quantity: a2, beside: [particles]}",
            "{quantity: a2, average: {start: 1.0}}",
            "table.average: only evolution runs take it",
        ),
    ],
)
def test_mistakes(tmp_path, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(tmp_path / "test.yaml", old, new)


def test_averages_are_of_particles(tables):
    study, files, _ = tables
    asked = study.model.experiments["particles"].table
    experiment = study.model.experiments["marching"].model_copy(update={"table": asked})
    with pytest.raises(ValueError, match="table.average: only method 'dsmc' has it, not e~0.7"):
        experiment_table(experiment, study.runs["marching"], files["marching"])


def test_other_tables_must_be_of_the_same_gases(tables):
    study, files, found = tables
    experiment = study.model.experiments["cooling"]
    twice = found["maxwell"]
    with pytest.raises(ValueError, match="'particles': has several runs with the same e"):
        experiment_table(experiment, study.runs["cooling"], files["cooling"], [twice])
    with pytest.raises(ValueError, match="table.beside='particles': its table has no a2"):
        without = found["particles"].drop_vars("a2")
        experiment_table(experiment, study.runs["cooling"], files["cooling"], [without])
    other = found["particles"].copy()
    other.attrs["swept"] = "N"
    with pytest.raises(ValueError, match="table.beside='particles': sweeps none of e"):
        experiment_table(experiment, study.runs["cooling"], files["cooling"], [other])
