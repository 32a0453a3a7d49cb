"""The workflow, run for real on a tiny study."""

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
from granstudy.study import write_schema

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
      - {e: [0.5], N: [8, 10], method: [fast]}
    table: {quantity: paper_temperature_error}
    figure: {kind: convergence, x: N}
"""


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
    """Numbers of jobs by rule that a dry run plans."""
    lines = snakemake(project, "-n", "--quiet", "rules").splitlines()
    counts = [line.split() for line in lines if len(line.split()) == 2]
    return {rule: int(n) for rule, n in counts if n.isdigit() and rule != "total"}


def edit(path, old, new):
    text = path.read_text()
    assert text.count(old) >= 1
    path.write_text(text.replace(old, new, 1))


def test_a_study_from_nothing_to_figures_and_what_edits_rerun(project):
    assert planned(project) == {"all": 1, "run": 2, "table": 1, "figure": 1}
    snakemake(project)
    results = project / "results" / "tiny"
    ds = read_dataset(results / "runs/convergence/e~0.5/N~8/method~fast.nc")
    assert float(ds["N"]) == 8 and ds["temperature"].sizes == {"time": 3}
    assert xr.open_dataset(results / "tables/convergence.nc").sizes["run"] == 2
    for name in ("tables/convergence.csv", "tables/convergence.md", "figures/convergence.png"):
        assert (results / name).stat().st_size > 0
    assert not list(results.rglob(".partial-*"))
    assert planned(project) == {}

    # A docstring and a comment: nothing.
    edit(project / "granstudy/evolve.py", '"""Time integration', '"""# Integration in time')
    assert planned(project) == {}
    # Plotting: the figure only.
    edit(project / "granstudy/figures.py", "\n\n\ndef ", "\n\nUNUSED = 1\n\n\ndef ")
    assert planned(project) == {"all": 1, "figure": 1}
    # The operator these runs do not use: still only that figure.
    edit(project / "granstudy/collision/literal.py", "BATCH = 2**15", "BATCH = 2**14")
    assert planned(project) == {"all": 1, "figure": 1}
    # The one they use: everything.
    edit(project / "granstudy/collision/fast.py", "SHARES = 8", "SHARES = 4")
    assert planned(project) == {"all": 1, "run": 2, "table": 1, "figure": 1}


def test_a_value_added_to_a_list_adds_runs_and_nothing_else(project):
    snakemake(project)
    edit(project / "tiny.yaml", "N: [8, 10]", "N: [8, 10, 12]")
    assert planned(project) == {"all": 1, "run": 1, "table": 1, "figure": 1}
    edit(project / "tiny.yaml", "t_final: 0.1", "t_final: 0.2")
    assert planned(project)["run"] == 3


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("N: [8, 10]", "N: [8, -10]", "N=-10: must be an even integer"),
        ("N_rho: 8", "N_roh: 8", "did you mean 'N_rho'?"),
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
    output = snakemake(
        project, "results/tiny/runs/convergence/e~0.5/N~14/method~fast.nc", succeeds=False
    )
    assert "has no run convergence/e~0.5/N~14/method~fast" in output


def test_a_killed_study_continues_where_it_stopped(project):
    edit(project / "tiny.yaml", "N: [8, 10]", "N: [8, 128]")
    edit(project / "tiny.yaml", "t_final: 0.1", "t_final: 50.0")  # N = 128 takes minutes
    process = start(project)
    first = project / "results/tiny/runs/convergence/e~0.5/N~8/method~fast.nc"
    for _ in range(1200):
        # The file alone is not enough: Snakemake must have noted that the job is done.
        logs = "".join(p.read_text() for p in (project / ".snakemake" / "log").glob("*.log"))
        if first.exists() and "Finished jobid" in logs:
            break
        time.sleep(0.1)
    assert first.exists(), "the small run should be done within two minutes"
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    written = first.stat().st_mtime_ns
    unfinished = first.parent.with_name("N~128") / "method~fast.nc"
    assert not unfinished.exists()

    edit(project / "tiny.yaml", "N: [8, 128]", "N: [8, 12]")
    snakemake(project, "--unlock")
    snakemake(project, "--rerun-incomplete")
    assert first.stat().st_mtime_ns == written
    assert read_dataset(first)["status"] == 0


def test_the_schema_that_editors_use_is_in_step(tmp_path):
    write_schema(tmp_path / "study.schema.json")
    committed = REPOSITORY / "workflow" / "config" / "study.schema.json"
    assert (tmp_path / "study.schema.json").read_text() == committed.read_text()
