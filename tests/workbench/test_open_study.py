"""A study in the hand: its runs and how they stand, its datasets, tables, figures and theory."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from gases import RADIAL, SHORT, my_gas, stored, sweep
from own_functions import imported

import granstudy as gs
from granstudy import theory
from granstudy.analysis.tables.table import experiment_table
from granstudy.runs import execute

COOLING = """
title: Cooling
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian2d, exponent: 1.0, diffusion: 0.0}
    solver: {method: radial, N: 12, R: 7.0}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - {e: [0.5, 0.7], temperature: [1.0]}
      - {e: [0.7], temperature: [2.0]}
    table: {quantity: temperature}
    figure: {kind: cooling}
"""

OTHERS = """
  collision:
    title: collisions
    run: collision
    scene: {name: maxwellian2d, diffusion: 0.0}
    solver: {N: 8, R: 7.0, N_rho: 4, M_cir: 4}
    reference: {method: direct, M_cir: 8}
    sweep:
      - {e: [0.5, 0.9], method: [fast]}
  law:
    title: a law of one's own
    run: evolution
    scene: {name: maxwellian2d, restitution: "my_gas.py:softening", diffusion: 0.0}
    solver: {method: fast, N: 8, R: 7.0, N_rho: 4, M_cir: 4}
    time: {t_final: 0.1, dt: 0.05, save_every: 2}
    sweep:
      - {kappa: [0.1, 0.2]}
  speed:
    title: speed
    run: benchmark
    scene: {name: maxwellian2d, e: 0.5, diffusion: 0.0}
    solver: {N: 8, R: 7.0, N_rho: 4, M_cir: 4}
    timing: {rounds: 1}
    sweep:
      - {method: [fast]}
"""


def study_file(text=COOLING, name="mine"):
    path = Path(f"{name}.yaml")
    path.write_text(text)
    return path


def opened(text=COOLING, name="mine"):
    return gs.open_study(study_file(text, name))


def changed(text, old, new):
    assert old in text
    return text.replace(old, new)


def states(study):
    return study.runs["state"].tolist()


def test_runs_and_what_is_left_before_and_after(here, computed):
    study = opened()
    assert states(study) == ["missing"] * 3 and (study.runs["seconds"] > 0.0).all()
    assert study.remaining.runs == 3 and study.remaining.memory_mb > 0
    # a tensor that two runs need counts once
    assert 0.0 < study.remaining.seconds <= study.runs["seconds"].sum()
    assert "0 of 3 runs are done; 3 left" in repr(study) and "cooling: cooling; 3 runs" in repr(
        study
    )
    assert not (here / "results").exists(), "opening a study writes nothing"
    study.compute(workers=1, progress=False)
    assert states(study) == ["done"] * 3 and set(study.runs["trust"]) <= {
        "trusted",
        "marginal",
        "untrusted",
    }
    assert (
        study.remaining.runs == 0
        and study.remaining.seconds == 0.0
        and "3 of 3 runs" in repr(study)
    )
    study.compute(workers=1, progress=False)
    assert len(computed) == 3


def test_a_study_built_in_python_is_the_study_of_the_file(computed):
    study = opened()
    study.compute(workers=1, progress=False)
    built = gs.open_study(yaml.safe_load(COOLING), name="built")
    assert built.name == "built" and states(built) == ["done"] * 3
    built.compute(workers=1, progress=False)
    assert len(computed) == 3
    assert built.dataset().identical(study.dataset())


def test_the_dataset_lies_over_what_is_swept_with_holes_where_no_run_is(computed):
    study = opened()
    with pytest.raises(ValueError, match=r"cooling: no run is there yet; study.compute\(\)"):
        study.dataset()
    study.compute(workers=1, progress=False)
    ds = study.dataset("cooling")
    assert ds["a2"].dims == ("e", "initial_temperature", "time")
    hole = ds.sel(e=0.5, initial_temperature=2.0)
    assert hole["status"] == -1 and hole["temperature"].isnull().all()
    assert int((ds["status"] == 0).sum()) == 3 and ds["N"].dims == ()
    stacked = study.dataset("cooling", stacked=True)
    assert stacked.sizes["run"] == 3 and set(stacked["run_key"].values) == set(study.runs["key"])


def test_kept_densities_and_references_are_there_on_request(here):
    my_gas(here)
    study = opened(COOLING + OTHERS)
    study.compute(workers=1, progress=False)
    law = study.dataset("law", densities=True)
    assert law["f"].dims == ("kappa", "snapshot", "vx", "vy")
    assert float(law["f"].sel(kappa=0.2).isel(snapshot=0).sum()) > 0.0
    assert "f" not in study.dataset("law")
    assert "snapshot" not in study.dataset("law").dims
    measured = study.dataset("collision")
    assert measured.sizes["e"] == 2 and set(measured["method"].values.flat) == {"fast"}
    with_references = study.dataset("collision", references=True)
    assert sorted(with_references["method"].values) == ["direct", "direct", "fast", "fast"]


def test_of_a_benchmark_is_what_snakemake_made(here):
    my_gas(here)
    study = opened(COOLING + OTHERS)
    for ask in (study.dataset, study.table, study.figure):
        with pytest.raises(ValueError, match="speed: .*"):
            ask("speed")
    timings = xr.Dataset({"seconds": ("run", [1.0])})
    gs.write_dataset(timings, study.layout.benchmark_file("speed"))
    assert study.dataset("speed").equals(timings)
    assert "speed" not in study.runs.index.get_level_values("experiment")


@pytest.mark.fault("A4")
def test_what_the_study_no_longer_has_is_in_nothing(here, computed):
    study = opened()
    study.compute(workers=1, progress=False)
    fewer = opened(changed(COOLING, "[0.5, 0.7]", "[0.7]"))
    fewer.show()
    ds = fewer.dataset()
    assert ds.sizes["initial_temperature"] == 2 and ds["e"].item() == 0.7
    assert len(fewer.runs) == 2 and len(stored(here / "results")) == 3
    runs = Path(fewer.layout.runs)
    files = [str(path.relative_to(runs)) for path in sorted(runs.rglob("*.nc"))]
    assert files == ["cooling/e~0.7/temperature~1.nc", "cooling/e~0.7/temperature~2.nc"]
    assert gs.open_runs(runs).sizes["run"] == 2
    # What comes back is not computed again.
    opened().compute(workers=1, progress=False)
    assert len(computed) == 3 and len(list(runs.rglob("*.nc"))) == 3


def test_a_run_is_stale_while_only_an_older_version_is_there(computed):
    opened().compute(workers=1, progress=False)
    longer = opened(changed(COOLING, "t_final: 0.1", "t_final: 0.2"))
    longer.show()
    assert states(longer) == ["stale"] * 3 and longer.remaining.runs == 3
    longer.compute(workers=1, progress=False)
    assert states(longer) == ["done"] * 3 and len(computed) == 6
    assert longer.dataset()["time"].max() == pytest.approx(0.2)


def test_a_failed_run_has_its_cause_and_the_others_stay(monkeypatch):
    compute = execute.execute

    def sometimes(computation, *more):
        if computation.scene.restitution == 0.5:
            raise ArithmeticError("overflow")
        return compute(computation, *more)

    monkeypatch.setattr(execute, "execute", sometimes)
    study = opened()
    study.compute(workers=1, progress=False)
    failed = study.runs.query("state == 'failed'")
    assert failed["reason"].tolist() == ["ArithmeticError: overflow"] and len(failed) == 1
    assert study.remaining.runs == 0
    assert (
        study.dataset().sel(e=0.5, initial_temperature=1.0)["reason"] == "ArithmeticError: overflow"
    )


def test_a_machine_that_fails_is_told_after_the_others_are_computed(here, monkeypatch):
    compute = execute.execute

    def sometimes(computation, *more):
        if computation.scene.restitution == 0.5:
            raise MemoryError("none left")
        return compute(computation, *more)

    monkeypatch.setattr(execute, "execute", sometimes)
    study = opened()
    with pytest.raises(
        RuntimeError, match=r"(?s)1 of 3 runs could not be computed:.*MemoryError: none"
    ):
        study.compute(workers=1, progress=False)
    assert states(study).count("done") == 2 and study.remaining.runs == 1


def test_an_interrupted_computation_keeps_what_it_did_and_the_study_has_it(
    here, monkeypatch, computed
):
    counted = execute.execute

    def stopped(computation, *more):
        if len(computed) == 2:
            raise KeyboardInterrupt
        return counted(computation, *more)

    monkeypatch.setattr(execute, "execute", stopped)
    study = opened()
    with pytest.raises(KeyboardInterrupt, match="2 of 3 runs are done and kept"):
        study.compute(workers=1, progress=False)
    assert len(list(Path(study.layout.runs).rglob("*.nc"))) == 2
    monkeypatch.setattr(execute, "execute", counted)
    study.compute(workers=1, progress=False)
    assert len(computed) == 3 and states(study) == ["done"] * 3


def test_table_and_figure_are_those_of_the_workflow(computed):
    study = opened()
    with pytest.raises(ValueError, match="cooling: 3 runs are missing"):
        study.table()
    study.compute(workers=1, progress=False)
    model, runs = study._study.model.experiments["cooling"], study._study.runs["cooling"]
    files = study.layout.run_files("cooling")
    assert study.table().identical(experiment_table(model, runs, files, []))
    figure = study.figure()
    assert len(figure.axes) > 0 and any(axes.lines for axes in figure.axes)
    with pytest.raises(ValueError, match="unknown experiment 'coolin'.*did you mean 'cooling'"):
        study.table("coolin")


def test_theory_stands_over_the_same_parameters(here):
    my_gas(here)
    study = opened(COOLING + OTHERS)
    study.compute(workers=1, progress=False)
    ds, said = study.dataset("cooling"), study.theory("cooling")
    assert said["haff_constant"].dims == ("e", "initial_temperature")
    own = said.sel(e=0.7, initial_temperature=2.0)
    T0 = float(ds["temperature"].sel(e=0.7, initial_temperature=2.0).isel(time=0))
    assert float(own["haff_constant"]) == theory.haff_constant(
        gs.VHS(1.0, ds["strength"].item()), 0.7, 2, T0=T0
    )
    assert float(own["cooling_state_a2"]) == theory.cooling_state_a2(0.7, 2, 1.0)
    assert np.isnan(own["heated_temperature"]) and own["haff_constant"].attrs["long_name"]
    assert study.theory("law")["cooling_state_a2"].isnull().all()
    with pytest.raises(ValueError, match="collision: collision runs have no temperature"):
        study.theory("collision")


@pytest.mark.fault("A4")
def test_two_studies_of_one_name_are_kept_apart(here):
    opened().compute(workers=1, progress=False)
    (here / "sub").mkdir()
    other = here / "sub/mine.yaml"
    other.write_text(COOLING)
    with pytest.raises(
        ValueError, match=r"sub/mine.yaml: results/mine holds the results of another"
    ):
        gs.open_study(other)
    with pytest.raises(ValueError, match="study 'mine': results/mine holds the results of"):
        gs.open_study(yaml.safe_load(COOLING), name="mine")
    (here / "mine.yaml").rename(here / "moved.yaml")
    assert states(gs.open_study(other)) == ["done"] * 3


def test_mistakes_are_one_line_each():
    with pytest.raises(ValueError, match=re.escape("experiments.cooling, run e~1.5")):
        opened(changed(COOLING, "[0.5, 0.7]", "[0.5, 1.5]"))
    with pytest.raises(ValueError, match="did you mean 'temperature'"):
        opened(changed(COOLING, "quantity: temperature", "quantity: temprature"))


# The same run, whoever asks


SHARED = """
title: shared
experiments:
  gas:
    title: gas
    run: evolution
    scene: SCENE
    solver: {method: fast, N: 8, R: 7.0, N_rho: 4, M_cir: 4}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - SWEEP
"""


@pytest.mark.parametrize(
    ("scene", "swept", "by_sweep"),
    [
        (
            "{name: maxwellian2d, e: 0.5, diffusion: 0.0}",
            "{temperature: [1, 2]}",
            lambda module: (
                "maxwellian2d",
                {"e": 0.5, "diffusion": 0},
                {"temperature": [1.0, 2.0]},
            ),
        ),
        (
            "{name: two_beams2d, e: 1, diffusion: 1.0e-3}",
            "{separation: [1, 2]}",
            lambda module: ("two_beams2d", {"diffusion": 1e-3}, {"separation": [1.0, 2.0]}),
        ),
        (
            '{name: "my_gas.py:anisotropic", e: 0.5, exponent: 1}',
            "{ratio: [1, 2]}",
            lambda module: (
                "my_gas.py:anisotropic",
                {"e": 0.5, "exponent": 1.0},
                {"ratio": [1.0, 2.0]},
            ),
        ),
        (
            '{name: "my_gas.py:anisotropic", exponent: 1}',
            "{ratio: [1, 2], e: [0.5]}",
            lambda module: (
                gs.load_scene(module.anisotropic, exponent=1),
                {},
                {"e": [0.5], "ratio": [1, 2]},
            ),
        ),
        (
            '{name: maxwellian2d, restitution: "my_gas.py:softening"}',
            "{kappa: [0.1, 0.2]}",
            lambda module: (
                "maxwellian2d",
                {"restitution": module.softening},
                {"kappa": [0.1, 0.2]},
            ),
        ),
        (
            "{name: maxwellian2d, restitution: viscoelastic}",
            "{A: [0, 0.2]}",
            lambda module: ("maxwellian2d", {"restitution": "viscoelastic"}, {"A": [0.0, 0.2]}),
        ),
    ],
)
def test_a_study_finds_what_a_sweep_computed_and_the_other_way_round(
    here, monkeypatch, computed, scene, swept, by_sweep
):
    module = imported(my_gas(here), monkeypatch)
    text = SHARED.replace("SCENE", scene).replace("SWEEP", swept)
    study = opened(text)
    given, fixed, over = by_sweep(module)
    solver = gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4)
    ds = sweep(given, solver, over=over, **SHORT, **fixed)
    assert len(computed) == 2 and states(study) == ["done"] * 2
    assert set(ds["run_key"].values.flat) == set(study.runs["key"])
    study.compute(workers=1, progress=False)
    assert len(computed) == 2
    name = next(
        iter(set(study.dataset().dims) & set(ds.dims) - {"time", "component", "component_"})
    )
    assert study.dataset()["temperature"].dims[0] == name


def test_refined_runs_are_shared(computed):
    ladder = {"N": [8, 12, 16], "temperature": 1e-3, "a2": 1e-3}
    sweep("maxwellian2d", RADIAL, over={"e": [0.5]}, refine=ladder, diffusion=0.0, **SHORT)
    made = len(computed)
    refine = "    refine: {N: [8, 12, 16], temperature: 1.0e-3, a2: 1.0e-3}\n    sweep:\n"
    text = SHARED.replace("SCENE", "{name: maxwellian2d, diffusion: 0.0}").replace(
        "SWEEP", "{e: [0.5]}"
    )
    text = re.sub(r"solver: .*", "solver: {method: radial, R: 7.0}", text).replace(
        "    sweep:\n", refine
    )
    study = opened(text)
    assert states(study) == ["done"]
    study.compute(workers=1, progress=False)
    assert len(computed) == made
