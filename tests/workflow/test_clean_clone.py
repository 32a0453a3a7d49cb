"""A shipped study leaves a clone as it was; committed results change on purpose only."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from granstudy.study.layout import Layout
from granstudy.study.study import load_study

REPOSITORY = Path(__file__).parents[2]

STUDY = """
title: quick, and over in a second
experiments:
  table1:
    title: "convergence in N"
    run: evolution
    scene: {name: bkw2d}
    solver: {R: 7.8, N_rho: 8, M_cir: 8, method: literal}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - {e: [0.5], N: [8, 10]}
    table: {quantity: temperature}
    figure: {kind: convergence, x: N}
"""


def run(folder, *command):
    done = subprocess.run(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": str(folder)}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    return done.stdout


@pytest.fixture
def clone(tmp_path):
    """A clone of what git knows, or would, whose study `quick` is over in a second."""
    for name in run(
        REPOSITORY, "git", "ls-files", "--cached", "--others", "--exclude-standard"
    ).splitlines():
        if (REPOSITORY / name).is_file():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(REPOSITORY / name, tmp_path / name)
    (tmp_path / "studies/quick.yaml").write_text(STUDY)
    run(tmp_path, "git", "init", "--quiet")
    run(tmp_path, "git", "add", "--all")
    person = ["-c", "user.name=A", "-c", "user.email=a@b.c"]
    run(tmp_path, "git", *person, "commit", "--quiet", "--message", "clone")
    return tmp_path


def changed(clone):
    lines = run(clone, "git", "status", "--porcelain", "--untracked-files=all").splitlines()
    return {line[3:]: line[:2].strip() for line in lines}


def test_a_shipped_study_leaves_a_clone_clean_until_its_results_are_taken(clone):
    shipped = ["--config", "study=studies/quick.yaml"]
    run(clone, sys.executable, "-m", "snakemake", "--cores", "2", *shipped)
    assert (clone / "results/quick/tables/table1.md").is_file()
    assert changed(clone) == {}

    said = run(clone, sys.executable, "docs/refresh_results.py", "quick")
    found = changed(clone)
    assert {Path(path).parts[:3] for path in found} == {("docs", "results", "quick")}
    assert found["docs/results/quick/tables/table1.md"] == "M"
    assert found["docs/results/quick/tables/table2.csv"] == "D", "the study has no such table"
    assert "missing table1.csv" in said and "removed docs/results/quick/tables/table2.csv" in said
    for name in ("tables/table1.csv", "tables/table1.nc", "figures/table1.svg"):
        new, taken = clone / "results/quick" / name, clone / "docs/results/quick" / name
        assert new.read_bytes() == taken.read_bytes()


def test_nothing_is_taken_of_a_study_that_was_not_run(clone):
    done = subprocess.run(
        [sys.executable, "docs/refresh_results.py", "quick"], cwd=clone, text=True,
        env=os.environ | {"PYTHONPATH": str(clone)}, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1 and "table1.nc: is not there" in done.stderr
    assert "run it first" in done.stderr and changed(clone) == {}


@pytest.mark.parametrize(
    "study", sorted((REPOSITORY / "studies").glob("*.yaml")), ids=lambda path: path.stem
)
def test_git_does_not_look_where_a_shipped_study_writes(study):
    written = Layout(load_study(study)).wanted
    asked = subprocess.run(
        ["git", "check-ignore", "--stdin"], cwd=REPOSITORY, input="\n".join(written), text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    assert asked.stdout.splitlines() == written
