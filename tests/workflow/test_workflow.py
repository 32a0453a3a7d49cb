"""The workflow, run for real on a tiny study; by `literal`, as nothing of it has to be compiled."""

import json
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


EVERYTHING = {"all", "run", "complete_convergence", "dataset", "table", "figure", "page"}
"""Rules that run for a study from nothing; the name of a job of runs ends in a hash over them."""


@pytest.fixture
def project(tmp_path):
    """A copy of what a clone holds, with a tiny study."""
    for name in ("granstudy", "profiles"):
        if not (REPOSITORY / name).is_dir():
            continue
        shutil.copytree(
            REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__")
        )
    shutil.copy(REPOSITORY / "Snakefile", tmp_path)
    (tmp_path / "tiny.yaml").write_text(STUDY)
    return tmp_path


def key_of(project, part):
    """Key of the run whose name has this part."""
    runs = json.loads((project / "results/tiny/runs/study.json").read_text())["runs"]
    (key,) = (key for name, key in runs.items() if part in name)
    return key


def start(project, *arguments, study="tiny.yaml"):
    environment = os.environ | {"PYTHONPATH": f"{project}{os.pathsep}{REPOSITORY}"}
    command = [sys.executable, "-m", "snakemake", "--cores", "2", *arguments]
    command += ["--config", f"study={study}"]
    return subprocess.Popen(
        command,
        cwd=project,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def snakemake(project, *arguments, succeeds=True, study="tiny.yaml"):
    process = start(project, *arguments, study=study)
    output = process.communicate()[0]
    assert (process.returncode == 0) == succeeds, output
    return output


def planned(project):
    """Jobs that a dry run plans, by rule."""
    lines = snakemake(project, "-n", "--quiet", "rules").splitlines()
    counts = [line.split() for line in lines if len(line.split()) == 2]
    rules = {rule for rule, n in counts if n.isdigit() and rule != "total"}
    return {"run" if rule.startswith("run_") else rule for rule in rules}


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
    output = snakemake(project)
    assert output.rstrip().endswith("  read    results/tiny/index.html")
    results = project / "results" / "tiny"
    assert (results / "report/convergence.html").is_file()
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
    edit(
        project / "granstudy/study/jobs.py", "LONGEST, SHORTEST = 60.0", "LONGEST, SHORTEST = 61.0"
    )
    assert planned(project) == set()
    # Plotting: the figure only.
    edit(project / "granstudy/analysis/figures/figure.py", "\n\n\ndef ", "\n\nUNUSED = 1\n\n\ndef ")
    assert planned(project) == {"all", "figure", "page"}
    # The operator these runs do not use: still only that figure.
    edit(
        project / "granstudy/collision/fourier/transforms.py", "CACHE_LINE = 64", "CACHE_LINE = 128"
    )
    assert planned(project) == {"all", "figure", "page"}
    # The one they use: everything.
    before = written(project)
    edit(project / "granstudy/collision/literal.py", "BATCH = 2**15", "BATCH = 2**14")
    assert planned(project) == EVERYTHING
    snakemake(project)
    after = written(project)
    assert after.keys() == before.keys() and all(after[name] > before[name] for name in after)
    # Where a figure fails, the page says so.
    edit(project / "granstudy/analysis/figures/figure.py", "UNUSED = 1", "STYLE = {'no': 'style'}")
    output = snakemake(project, succeeds=False)
    assert output.rstrip().endswith("  read    results/tiny/index.html")
    page = (results / "index.html").read_text()
    assert "figure convergence: not made" in page and "<table>" in page


@pytest.mark.slow
def test_snakemakes_own_report_has_the_page_tables_and_figures(project):
    snakemake(project)
    snakemake(project, "--report", "report.html")
    report = (project / "report.html").read_text()
    for part in ("The study on one page", "Tables", "Figures", "convergence in N"):
        assert part in report
    for name in ("index.html", "convergence.svg", "convergence.html"):
        assert name in report


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
        ("e: [0.5]", "e: [1.5]", "e=1.5: must be a number between 0 and 1"),
    ],
)
def test_bad_studies_get_one_clear_error_before_any_work(project, old, new, message):
    edit(project / "tiny.yaml", old, new)
    output = snakemake(project, succeeds=False)
    assert message in output
    assert "Traceback" not in output
    assert not (project / "results").exists()


@pytest.mark.fault("A6", "B8")
def test_a_study_of_another_name_and_a_deleted_or_damaged_run(project):
    """The store knows a run by what it depends on: nothing is computed twice, nothing damaged stays."""
    snakemake(project)
    before = written(project)
    shutil.move(project / "results/tiny/runs", project / "gone")
    assert planned(project) == set(), "names are given anew, and no run is computed"
    assert written(project) == before

    (project / "tiny.yaml").rename(project / "renamed.yaml")
    (project / "tiny.yaml").symlink_to("renamed.yaml")
    snakemake(project, study="renamed.yaml")
    renamed = project / "results/renamed/runs"
    assert {p.name: p.stat().st_ino for p in renamed.rglob("*.nc")} == {
        p.name: p.stat().st_ino for p in (project / "results/tiny/runs").rglob("*.nc")
    }

    (path,) = (project / "results/.runs").rglob(f"{key_of(project, 'N~8')}.nc")
    (other,) = (project / "results/.runs").rglob(f"{key_of(project, 'N~10')}.nc")
    times, table = os.stat(path), project / "results/tiny/tables/convergence.csv"
    path.write_bytes(other.read_bytes())  # the file of another run, as old as the right one
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    right = table.read_bytes()
    table.unlink()
    output = snakemake(project, succeeds=False)
    assert "1 runs were damaged, or files of other runs" in output and not table.exists()
    snakemake(project)
    assert table.read_bytes() == right
    before = written(project)

    path.unlink()
    assert planned(project) == EVERYTHING
    snakemake(project)
    after = written(project)
    assert [name for name in after if after[name] != before[name]] == [
        "convergence/e~0.5/N~8/method~literal.nc.json"
    ]


def test_a_study_file_cannot_take_the_results_of_another_one(project):
    snakemake(project)
    other = project / "elsewhere"
    other.mkdir()
    shutil.copy(project / "tiny.yaml", other)
    output = snakemake(project, study="elsewhere/tiny.yaml", succeeds=False)
    assert "holds the results of another study" in output and "Traceback" not in output
    (project / "tiny.yaml").unlink()
    snakemake(project, study="elsewhere/tiny.yaml")  # the other file is gone, and with it its claim


def test_values_taken_out_of_a_sweep_leave_the_folder_and_stay_in_the_store(project):
    snakemake(project)
    edit(project / "tiny.yaml", "N: [8, 10]", "N: [8]")
    snakemake(project)
    assert set(written(project)) == {"convergence/e~0.5/N~8/method~literal.nc.json"}
    edit(project / "tiny.yaml", "N: [8]", "N: [8, 10]")
    assert planned(project) == EVERYTHING - {"run", "complete_convergence"}


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
    assert not list((results / "runs").rglob("*.nc"))
