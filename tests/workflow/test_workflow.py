"""The workflow, run for real on a tiny study; by `literal`, as nothing of it has to be compiled."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

from granstudy import read_dataset

REPOSITORY = Path(__file__).parents[2]

STUDY = """
title: tiny
experiments:
  convergence:
    title: "convergence in N"
    run: evolution
    scene: {name: bkw2d}
    solver: {R: 7.8, N_rho: 8, M_cir: 8}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - {e: [0.5], N: [8, 10], method: [literal]}
    table: {quantity: paper_temperature_error}
    figure: {kind: convergence, x: N}
"""


EVERYTHING = {"all", "run_convergence_1", "table", "figure"}


@pytest.fixture
def project(tmp_path):
    """A copy of what a clone holds, with a tiny study."""
    for name in ("granstudy", "workflow"):
        shutil.copytree(
            REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__")
        )
    shutil.copy(REPOSITORY / "Snakefile", tmp_path)
    (tmp_path / "tiny.yaml").write_text(STUDY)
    return tmp_path


def start(project, *arguments):
    environment = os.environ | {"PYTHONPATH": str(project)}
    command = [sys.executable, "-m", "snakemake", "--cores", "2", *arguments]
    command += ["--config", "study=tiny.yaml"]
    return subprocess.Popen(
        command,
        cwd=project,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def snakemake(project, *arguments, succeeds=True):
    process = start(project, *arguments)
    output = process.communicate()[0]
    assert (process.returncode == 0) == succeeds, output
    return output


def planned(project):
    """Jobs that a dry run plans, by rule."""
    lines = snakemake(project, "-n", "--quiet", "rules").splitlines()
    counts = [line.split() for line in lines if len(line.split()) == 2]
    return {rule for rule, n in counts if n.isdigit() and rule != "total"}


def written(project):
    """When each run was computed; Snakemake sets one time on all files of a job, so by the sidecars."""
    runs = project / "results/tiny/runs"
    return {
        str(path.relative_to(runs)): path.stat().st_mtime_ns for path in runs.rglob("*.nc.json")
    }


def edit(path, old, new):
    text = path.read_text()
    assert text.count(old) >= 1
    path.write_text(text.replace(old, new, 1))


def test_a_study_from_nothing_to_figures_and_what_edits_rerun(project):
    assert planned(project) == EVERYTHING
    snakemake(project)
    results = project / "results" / "tiny"
    ds = read_dataset(results / "runs/convergence/e~0.5/N~8/method~literal.nc")
    assert float(ds["N"]) == 8 and ds["temperature"].sizes == {"time": 3}
    assert xr.open_dataset(results / "tables/convergence.nc").sizes["run"] == 2
    for name in ("tables/convergence.csv", "tables/convergence.md", "figures/convergence.png"):
        assert (results / name).stat().st_size > 0
    assert not list(results.rglob(".partial-*"))
    assert planned(project) == set()

    # A docstring and a comment: nothing.
    edit(
        project / "granstudy/evolution/evolve.py", '"""Time integration', '"""# Integration in time'
    )
    assert planned(project) == set()
    # A method that these runs do not use, or how a study is divided into jobs: nothing.
    edit(
        project / "granstudy/collision/choice/methods.py",
        "OPERATORS: ",
        "NEW = None\n\nOPERATORS: ",
    )
    edit(project / "granstudy/study/jobs.py", "JOB_SECONDS = 60.0", "JOB_SECONDS = 61.0")
    assert planned(project) == set()
    # Plotting: the figure only.
    edit(project / "granstudy/analysis/figures/figure.py", "\n\n\ndef ", "\n\nUNUSED = 1\n\n\ndef ")
    assert planned(project) == {"all", "figure"}
    # The operator these runs do not use: still only that figure.
    edit(
        project / "granstudy/collision/fourier/transforms.py", "CACHE_LINE = 64", "CACHE_LINE = 128"
    )
    assert planned(project) == {"all", "figure"}
    # The one they use: everything.
    edit(project / "granstudy/collision/literal.py", "BATCH = 2**15", "BATCH = 2**14")
    assert planned(project) == EVERYTHING
    before = written(project)
    snakemake(project)
    after = written(project)
    assert after.keys() == before.keys() and all(after[name] > before[name] for name in after)


def test_a_value_added_to_a_list_adds_runs_and_nothing_else(project):
    snakemake(project)
    before = written(project)
    edit(project / "tiny.yaml", "N: [8, 10]", "N: [8, 10, 12]")
    assert planned(project) == EVERYTHING
    snakemake(project)
    after = written(project)
    assert after.keys() - before.keys() == {"convergence/e~0.5/N~12/method~literal.nc.json"}
    assert before.items() <= after.items()
    edit(project / "tiny.yaml", "t_final: 0.1", "t_final: 0.2")
    assert planned(project) == EVERYTHING


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("N: [8, 10]", "N: [8, -10]", "N=-10: must be an even integer"),
        ("N_rho: 8", "N_roh: 8", "did you mean 'N_rho'?"),
        ("kind: convergence", "kind: convergense", "figure.kind: unknown kind 'convergense'"),
        ("name: bkw2d", "name: bkw2", "did you mean 'bkw2d'?"),
        ("e: [0.5]", "e: [1.5]", "restitution=1.5: must lie between 0 and 1"),
    ],
)
def test_bad_studies_get_one_clear_error_before_any_work(project, old, new, message):
    edit(project / "tiny.yaml", old, new)
    output = snakemake(project, succeeds=False)
    assert message in output
    assert "Traceback" not in output
    assert not (project / "results").exists()


def test_a_path_outside_the_study_is_refused(project):
    path = "results/tiny/runs/convergence/e~0.5/N~14/method~literal.nc"
    assert "MissingRuleException" in snakemake(project, path, succeeds=False)


def test_a_killed_study_continues_where_it_stopped(project):
    edit(project / "tiny.yaml", "N: [8, 10]", "N: [8, 512]")
    edit(project / "tiny.yaml", "N_rho: 8, M_cir: 8", "N_rho: 128, M_cir: 128")
    process = start(project)
    runs = project / "results/tiny/runs/convergence/e~0.5"
    first, second = runs / "N~8/method~literal.nc", runs / "N~512/method~literal.nc"
    for _ in range(1200):
        if first.exists():
            break
        time.sleep(0.1)
    assert first.exists(), "the small run should be done within two minutes"
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = written(project)
    assert not second.exists(), "N = 512 takes minutes"

    edit(project / "tiny.yaml", "N: [8, 512]", "N: [8, 12]")
    snakemake(project, "--unlock")
    snakemake(project, "--rerun-incomplete")
    assert before.items() <= written(project).items()
    assert read_dataset(first)["status"] == 0


def test_the_plan_of_a_study_is_written_and_computes_no_run(project):
    snakemake(project, "plan")
    results = project / "results/tiny"
    assert "convergence/e~0.5/N~10/method~literal" in (results / "plan.md").read_text()
    assert len((results / "plan.csv").read_text().splitlines()) == 3
    assert not (results / "runs").exists()
