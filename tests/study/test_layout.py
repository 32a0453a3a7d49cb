"""Where results lie: the paths that a study's rules make and ask for."""

from pathlib import Path

import pytest

from granstudy.study.layout import NOTEBOOKS, Layout
from granstudy.study.study import load_study

REPOSITORY = Path(__file__).parents[2]
CONFIG = REPOSITORY / "studies"

STUDY = """
title: test
map: {title: labels}
experiments:
  law:
    title: law
    run: evolution
    scene: {name: bkw2d, restitution: 0.5}
    solver: {R: 7.0, N: 8, method: radial}
    time: {t_final: 0.2, dt: 0.1}
    truth: {law: maxwell}
    sweep:
      - {e: [0.2, 0.5]}
    table: {quantity: temperature}
  cooling:
    title: cooling
    run: state
    state: cooling
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 16, R: 8.0, method: radial}
    sweep:
      - {e: 0.5}
    table: {quantity: a2, beside: [law]}
    figure: {kind: states, beside: [law, speed]}
  speed:
    title: speed
    run: benchmark
    scene: {name: bkw2d, restitution: 0.5}
    solver: {R: 7.0, N: 8}
    reference: {method: direct}
    sweep:
      - {M_cir: [4, 8], method: [fast, literal]}
"""


@pytest.fixture
def layout(load):
    return Layout(load(), "made")


def test_runs_and_tables_lie_in_folders_of_the_study(layout):
    assert layout.run_files("law") == [f"made/test/runs/law/e~{e}.nc" for e in ("0.2", "0.5")]
    assert layout.run_files("speed") == ["made/test/benchmarks/speed.nc"]
    assert layout.beside_table("cooling") == ["made/test/tables/law.nc"]
    assert layout.beside_figure("cooling") == [
        "made/test/tables/law.nc",
        "made/test/tables/speed.nc",
    ]
    assert layout.beside_figure("speed") == layout.beside_table("law") == []


def test_the_study_asks_for_its_tables_figures_and_map(layout):
    tables = [
        f"made/test/tables/{n}.{form}" for n in ("law", "cooling") for form in ("nc", "csv", "md")
    ]
    figures = [f"made/test/figures/cooling.{form}" for form in ("png", "svg")]
    made_of_all = ["made/test/tables/map.nc", "made/test/figures/map.png"]
    assert layout.reported == [*layout.datasets, *tables, *figures, *made_of_all]
    assert layout.wanted == [*layout.reported, "made/test/index.html"]
    assert layout.tabled == ["map", "law", "cooling"]
    assert layout.map_tables == ["made/test/tables/law.nc"]


def test_benchmarks_are_no_runs_of_their_own(layout):
    assert {member.experiment for member in layout.study.members} == {"law", "cooling"}
    assert layout.dataset("speed") == "made/test/benchmarks/speed.nc"
    assert layout.dataset("law") == "made/test/datasets/law.nc"


def test_a_benchmark_depends_on_its_runs_their_references_and_its_timing(load):
    def parts(old="", new=""):
        layout = Layout(load(old, new))
        return layout.benchmark_parameters("speed"), layout.benchmark_code("speed")

    parameters, code = parts()
    # four runs and the one reference of all, then the timing; three methods, then what times them
    assert len(parameters) == 6 and len(code) == 4
    others, same = parts("reference: {method: direct}", "reference: {method: direct, N_rho: 9}")
    assert same == code and sum(a != b for a, b in zip(parameters, others, strict=True)) == 1
    timed, same = parts("reference:", "timing: {rounds: 2}\n    reference:")
    assert same == code and timed[:-1] == parameters[:-1] and timed[-1] != parameters[-1]


def test_the_notebooks_of_shipped_studies_are_there_and_open_runs_of_theirs():
    for name, notebooks in NOTEBOOKS.items():
        layout = Layout(load_study(CONFIG / f"{name}.yaml"))
        for notebook, experiments in notebooks.items():
            assert (REPOSITORY / f"notebooks/{notebook}.ipynb").is_file()
            files = [layout.dataset(other) for other in experiments]
            assert layout.notebook_files(notebook) == files
        assert layout.notebooks == [f"results/{name}/notebooks/{n}.ipynb" for n in notebooks]
