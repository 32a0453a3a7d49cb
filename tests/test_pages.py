"""The code of the pages runs: Python from top to bottom, commands as they are typed, YAML as studies."""

import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
import yaml

from granstudy.commands.main import granstudy
from granstudy.study.study import load_study

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]

OWN_TEST = {"extending.md"}
"""Pages whose Python runs in a test of their own."""

BASE = """
title: page
experiments:
  page:
    title: page
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0, e: 0.5}
    solver: {R: 8.0, rtol: 1.0e-3, N: 16}
    time: {t_final: 1.0, time_rtol: 1.0e-4}
    sweep:
      - {method: [fast]}
"""
"""A study that a piece of one on a page is put into."""

LANGUAGES = {"python", "yaml", "sh", "{toctree}", "{include}", "{eval-rst}"}
"""What blocks of code on the pages are; the last three are the site's own."""

TYPED_ELSEWHERE = (
    "python3 -m venv",
    "pip install",
    ". .venv",
    ".venv/bin/",
    "apt-get ",
    "pre-commit ",
)
"""Starts of commands that change the machine; `.ci/run` and `tests/test_wheel.py` type their like."""


def blocks(page, language):
    text = page.read_text("utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.M | re.S)


def with_blocks(language):
    return [page for page in PAGES if blocks(page, language) and page.name not in OWN_TEST]


def typed(page):
    """Commands on a page, each in one line."""
    text = "\n".join(blocks(page, "sh")).replace("\\\n", " ").replace("&&\n", "&& ")
    lines = [line.split("  #")[0].strip() for line in text.splitlines()]
    return [line for line in lines if line and not line.startswith(TYPED_ELSEWHERE)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_code_says_what_it_is(page):
    fences = re.findall(r"^```(.*)$", page.read_text("utf-8"), re.M)
    assert fences[1::2] == [""] * (len(fences) // 2)
    assert {fence.split()[0] if fence else "" for fence in fences[::2]} <= LANGUAGES
    prose = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.M | re.S)
    if page.parent.name == "docs":
        assert not re.search(r"^\n {4}\S.*\n", prose, re.M), "a block without a fence"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with what the pages begin with: the study of `granstudy new`, a density of one's own.

    Committed results are where they are in a clone.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs").symlink_to(ROOT / "docs")
    template = ROOT / "granstudy" / "commands" / "templates"
    shutil.copyfile(template / "cooling.yaml", "my_study.yaml")
    shutil.copyfile(template / "my_gas.py", "my_gas.py")
    return tmp_path


@pytest.mark.parametrize("page", with_blocks("python"), ids=lambda page: page.name)
def test_python_of_a_page_runs(page, folder):
    code = "\n".join(blocks(page, "python"))
    body = textwrap.indent(f"import matplotlib\nmatplotlib.use('Agg')\n{code}", "    ")
    (folder / "page.py").write_text(f"if __name__ == '__main__':\n{body}", encoding="utf-8")
    if 'open_study("my_study.yaml")' in code:  # which reads what `granstudy run` made
        made = "import granstudy as gs; gs.open_study('my_study.yaml').compute(progress=False)"
        subprocess.run([sys.executable, "-c", made], cwd=folder, check=True)
    done = subprocess.run(
        [sys.executable, "page.py"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]


@pytest.mark.parametrize("page", with_blocks("yaml"), ids=lambda page: page.name)
def test_yaml_of_a_page_is_a_study_or_a_piece_of_one(page, folder):
    for number, text in enumerate(blocks(page, "yaml")):
        said = yaml.safe_load(text)
        if "experiments" not in said:
            base = yaml.safe_load(BASE)
            base["experiments"]["page"] |= said
            if "accuracy" in said:  # in place of solver and steps
                del base["experiments"]["page"]["solver"]
                del base["experiments"]["page"]["scene"]["e"]
                base["experiments"]["page"] |= {"time": {"t_final": 1.0}, "sweep": [{"e": [0.5]}]}
            if "N" in said.get("refine", {}) or "N" in str(said.get("sweep", "")):
                del base["experiments"]["page"]["solver"]["N"]
            if "scene" in str(said.get("sweep", "")):
                base["experiments"]["page"]["scene"] |= {"name": "maxwellian3d"}
            said = base
        Path(f"piece{number}.yaml").write_text(yaml.safe_dump(said))
        assert load_study(f"piece{number}.yaml").members


@pytest.mark.parametrize("page", with_blocks("sh"), ids=lambda page: page.name)
def test_commands_of_a_page_are_commands(page):
    for line in typed(page):
        words = re.sub(r'^PATH="\S+" ', "", line).split()
        if words[0] == "granstudy":
            assert words[1] in granstudy.commands, line
        elif words[0] in {"python", "bash"}:
            assert words[1] == "-m" or (ROOT / words[1]).is_file(), line
        else:
            assert words[0] in {"snakemake", "pytest", "sphinx-build"}, line


@pytest.mark.parametrize("name", ["tutorial.md", "how_to.md"])
def test_commands_of_a_page_run(name, folder):
    Path("my_study.yaml").unlink()
    for line in typed(ROOT / "docs" / name):
        only_planned = (
            " -n" if line.startswith("granstudy run") else ""
        )  # computed in Python, above
        if "profiles/slurm" in line and not has_slurm():
            continue
        if Path("my_study.yaml").exists() and line.startswith("granstudy new"):
            continue
        done = subprocess.run(
            line + only_planned, shell=True, cwd=folder, capture_output=True, text=True, check=False,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"


def has_slurm():
    """Whether Snakemake's plugin for Slurm is installed."""
    known = "import snakemake_executor_plugin_slurm"
    return subprocess.run([sys.executable, "-c", known], check=False).returncode == 0
