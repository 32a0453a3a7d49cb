"""States in a study: their runs, their table beside theory and other experiments, their figure."""

import json

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.analysis.figures.states import UNIT
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.plan import study_forecasts
from granstudy.analysis.tables.table import csv_table, write_table
from granstudy.runs.estimates import estimate_run
from granstudy.runs.run_key import run_key
from granstudy.trust.flags import Trust

STUDY = """
title: states
experiments:
  cooling:
    title: cooling
    run: state
    state: cooling
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 24, R: 9.0, method: radial}
    sweep:
      - {e: [0.6, 0.8]}
    table: {quantity: a2, beside: [particles]}
    figure: {kind: states}
  particles:
    title: particles
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 16, R: 7.0, method: dsmc, particles: 2000, batches: 10}
    time: {t_final: 40.0, time_rtol: 1.0e-6, times: {first: 10.0, per_decade: 20}}
    sweep:
      - {e: [0.8, 0.9]}
    table: {quantity: a2, average: {start: 10.0}}
  maxwell:
    title: maxwell
    run: state
    state: heated
    scene: {name: maxwellian2d, exponent: 0.0, diffusion: 0.1}
    solver: {method: radial}
    sweep:
      - {e: [0.7, 0.9], N: 14, R: 8.0}
      - {e: [0.7, 0.9], N: 24, R: 9.0}
    table: {quantity: a2_error}
    figure: {kind: states}
  marching:
    title: marching
    run: evolution
    scene: {name: maxwellian2d, exponent: 0.0, diffusion: 0.06375}
    solver: {N: 24, R: 9.0, method: radial}
    time: {t_final: 150.0, time_rtol: 1.0e-8}
    sweep:
      - {e: 0.7}
    table: {quantity: a2}
  direct:
    title: direct
    run: state
    state: heated
    scene: {name: maxwellian2d, exponent: 0.0, diffusion: 0.06375}
    solver: {N: 40, R: 9.0, method: auto}
    sweep:
      - {e: 0.7}
    table: {quantity: a2, beside: [marching]}
"""


def test_a_run_is_the_state_that_python_finds(made):
    study, files, found = made.study, made.files, made.tables
    run = study.run("cooling", "e~0.8")
    state = gs.cooling_state(run.scene, run.solver)
    for name in ("a2", "a3", "cooling_coefficient"):
        assert float(found["cooling"][name][1]) == float(state[name])
    assert gs.read_dataset(files["cooling"][1]).attrs["title"] == "granstudy cooling state"
    assert found["cooling"]["trust"].values[1] == Trust.TRUSTED
    # opened together, as any runs
    last = gs.unstack_runs(gs.final_values(files["cooling"]))
    assert float(last["a2"].sel(e=0.8)) == float(state["a2"])


def test_theory_stands_beside(made):
    found = made.tables
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


def test_particles_stand_beside_the_same_gases(made):
    """At the one e that both sweep, within their errors; at others there is no number."""
    found = made.tables
    table, particles = found["cooling"], found["particles"]
    assert np.isnan(table["a2_particles"][0])
    assert float(table["a2_particles"][1]) == float(particles["a2"][0])
    difference = float(table["a2_particles_difference"][1])
    assert difference == pytest.approx(float(particles["a2"][0] - table["a2"][1]))
    assert abs(difference) < 4 * float(table["a2_particles_standard_error"][1])
    assert "temperature_particles" not in table


def test_marching_and_solving_come_to_the_same_heated_state(made):
    table = made.tables["direct"]
    for name in ("a2", "temperature"):
        assert abs(float(table[f"{name}_marching_difference"][0])) < 1e-6
    assert "a2_marching_standard_error" not in table


def test_tables_are_written(made, tmp_path):
    table = made.tables["cooling"]
    write_table(table, *(tmp_path / f"cooling.{kind}" for kind in ("nc", "csv", "md")))
    assert gs.read_dataset(tmp_path / "cooling.nc").attrs["state"] == "cooling"
    header, _, second = csv_table(table).splitlines()
    assert header.startswith("e,a2,a2_linear,a2_divided,a2_particles,")
    assert second.split(",")[0] == "0.8" and "trusted" in second
    assert f"| {float(table['a2'][1]):.6f} |" in markdown_table(table)


def test_a_figure_shows_table_and_theory(made):
    found = made.tables
    upper, lower = made.draw("cooling").axes
    lines = {line.get_label(): line for line in upper.lines}
    np.testing.assert_array_equal(lines["solved for"].get_ydata(), found["cooling"]["a2"])
    curve = lines["linear theory (van Noije & Ernst)"]
    e = curve.get_xdata()[40]
    assert curve.get_ydata()[40] == pytest.approx(theory.cooling_state_a2(e))
    (bars,) = lower.containers
    segment = bars.lines[2][0].get_segments()[1]
    width = 4 * float(found["cooling"]["a2_particles_standard_error"][1]) / UNIT
    assert segment[1, 1] - segment[0, 1] == pytest.approx(width)
    _, lower = made.draw("maxwell").axes
    assert lower.get_yscale() == "log"
    coarse = next(line for line in lower.lines if line.get_label() == "$N$ = 14, $R$ = 8")
    np.testing.assert_array_equal(coarse.get_ydata(), found["maxwell"]["a2_error"][:2])
    labels = [text.get_text() for text in made.draw("maxwell").legends[0].get_texts()]
    trust = found["maxwell"]["trust"].values
    for label in (Trust.MARGINAL, Trust.UNTRUSTED):
        assert (label.name.lower() in labels) == bool((trust == label).any())


def test_a_figure_needs_states(made):
    with pytest.raises(ValueError, match="particles: is no table of states swept over e"):
        made.draw("cooling", table=made.tables["particles"])


def test_what_a_state_will_take(made):
    """The solver of an isotropic state is chosen for it, and its evaluations of Q are counted."""
    study, files = made.study, made.files
    (run,) = study.runs["direct"].values()
    estimate = estimate_run(run.computation)
    assert estimate.choice.solver.method == "radial"
    chosen = json.loads(gs.read_dataset(files["direct"][0]).attrs["solver"])
    assert chosen["N"] == estimate.choice.solver.N
    forecast = dict(study_forecasts(study))["direct/e~0.7"]
    assert forecast.evaluations == estimate.evaluations > 2 * chosen["N"]
    assert forecast.seconds > estimate.evaluations * forecast.seconds_per_evaluation
    assert estimate.cost.evaluations == estimate.evaluations


def test_keys_of_states_are_their_own(made, tmp_path):
    study = made.study
    run = study.run("cooling", "e~0.8")
    assert json.loads(run.computation.parameters)["run"] == "cooling state"
    assert run_key(run.computation) != run_key(study.run("cooling", "e~0.6").computation)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("    state: cooling\n", "", "state: state runs need it, cooling or heated"),
        ("state: cooling", "state: coling", "experiments.cooling.state: value 'coling'"),
        ("{e: [0.6, 0.8]}", "{e: [0.6], dt: 0.1}", "sweep: 'dt' is of times, which only evolution"),
        ("{e: [0.6, 0.8]}", "{e: [0.6, 1.0]}", "restitution=1.0: must be below 1"),
        ("{e: [0.6, 0.8]}", "{e: 0.6, diffusion: 0.1}", "diffusion=0.1: a cooling state has none"),
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
def test_mistakes(load, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(old, new)


def test_averages_are_of_particles(made):
    asked = made.experiment("particles").table
    experiment = made.experiment("marching").model_copy(update={"table": asked})
    with pytest.raises(ValueError, match="table.average: only method 'dsmc' has it, not e~0.7"):
        made.table("marching", experiment)


def test_other_tables_must_be_of_the_same_gases(made):
    found = made.tables
    with pytest.raises(ValueError, match="'particles': has several runs with the same e"):
        made.table("cooling", beside=[found["maxwell"]])
    with pytest.raises(ValueError, match="table.beside='particles': its table has no a2"):
        made.table("cooling", beside=[found["particles"].drop_vars("a2")])
    other = found["particles"].copy()
    other.attrs["swept"] = "N"
    with pytest.raises(ValueError, match="table.beside='particles': sweeps none of e"):
        made.table("cooling", beside=[other])
