"""`granstudy new`, `init`, `check`, `plan`, `cite`."""

import re
from pathlib import Path

import pytest

import granstudy as gs
from granstudy.commands.starting import TEMPLATES

REPOSITORY = Path(__file__).parents[2]


@pytest.mark.parametrize("template", TEMPLATES)
def test_every_template_is_a_study_without_mistakes(type_, template):
    status, output = type_(f"new first.yaml --template {template}")
    assert status == 0 and "wrote first.yaml" in output and "granstudy plan first.yaml" in output
    assert "my_study" not in Path("first.yaml").read_text()
    status, output = type_("check first.yaml")
    assert status == 0, output
    assert re.fullmatch(r"first.yaml: \d experiments?, \d+ runs, no mistakes\n", output)


def test_nothing_is_written_over(type_):
    status, output = type_("new mine.yaml")
    assert (status, output) == (1, "Error: mine.yaml: is there already; take another name\n")
    Path("my_gas.py").write_text("mine")
    status, output = type_("new other.yaml --template own_gas")
    assert status == 1 and "my_gas.py: is there already" in output
    assert not Path("other.yaml").exists() and Path("my_gas.py").read_text() == "mine"


def test_a_folder_is_made_for_snakemake(type_):
    status, output = type_("init")
    assert status == 0 and "wrote Snakefile" in output and "then snakemake --cores 2" in output
    assert {str(path) for path in Path().rglob("*") if path.is_file()} == {
        "Snakefile",
        "mine.yaml",
        "profiles/default/config.yaml",
        "profiles/slurm/config.yaml",
    }
    before = Path("Snakefile").read_text()
    assert 'setdefault("study", "my_study.yaml")' in before
    status, output = type_("init --study other.yaml")
    assert status == 1 and "Snakefile: is there already" in output
    assert Path("Snakefile").read_text() == before
    status, output = type_("init inside --study other.yaml")
    assert status == 0 and "next: in inside: granstudy new other.yaml" in output
    assert 'setdefault("study", "other.yaml")' in Path("inside/Snakefile").read_text()


def test_a_clone_is_such_a_folder(here, type_):
    assert type_("init --study studies/paper.yaml")[0] == 0
    for name in ("profiles/default/config.yaml", "profiles/slurm/config.yaml"):
        assert Path(name).read_text() == (REPOSITORY / name).read_text(), name

    def code(path):
        return [line for line in path.read_text().splitlines() if not line.startswith("#")]

    assert code(Path("Snakefile")) == code(REPOSITORY / "Snakefile")


def test_an_unknown_template_is_told(type_):
    status, output = type_("new other.yaml --template coolin")
    assert status == 1 and "unknown template 'coolin' (did you mean 'cooling'?)" in output


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("e: [0.5, 0.7]", "e: [0.5, 1.7]", "experiments.cooling, run e~1.7: "),
        ("quantity: temperature", "quantity: temprature", "did you mean 'temperature'"),
        ("N: 12", "M: 12", "solver.M: unknown field"),
        ("maxwellian2d", "my_gas.py:f", "there is no file"),
        ("title: cooling", "title: [", "not YAML"),
    ],
)
def test_mistakes_are_lines_without_a_traceback(type_, old, new, told):
    text = Path("mine.yaml").read_text()
    assert old in text
    Path("mine.yaml").write_text(text.replace(old, new))
    for command in ("check", "plan"):
        status, output = type_(f"{command} mine.yaml")
        assert status == 1 and output.startswith("Error: mine.yaml: ") and told in output
        if "YAML" not in told:
            assert output.count("\n") == 1


def test_a_study_whose_folder_has_another_owner_is_told(type_, here):
    gs.open_study("mine.yaml").show()
    (here / "sub").mkdir()
    Path("sub/mine.yaml").write_text(Path("mine.yaml").read_text())
    status, output = type_("check sub/mine.yaml")
    assert status == 1 and "results/mine holds the results of another study" in output
    assert type_("check sub/mine.yaml --results others")[0] == 0


def test_a_file_that_is_missing_is_told(type_):
    status, output = type_("check nothing.yaml")
    assert status == 2 and "nothing.yaml" in output


def test_the_plan_says_what_is_done_and_what_is_left(type_):
    status, output = type_("plan mine.yaml")
    assert status == 0 and "0 of 2" in output and "2 runs are left" in output
    assert "next: granstudy run mine.yaml" in output
    gs.open_study("mine.yaml").compute(workers=1, progress=False)
    status, output = type_("plan mine.yaml --cores 1")
    assert status == 0 and "2 of 2" in output and "All runs are done" in output


def test_what_to_cite_is_bibtex(type_):
    status, output = type_("cite")
    assert status == 0 and output.count("@") == 2 and "10.1016/j.jcp.2019.01.049" in output
    assert output.count("{") == output.count("}")


def test_help_names_every_command(type_):
    status, output = type_("-h")
    assert status == 0
    for name in (
        "new",
        "init",
        "check",
        "plan",
        "run",
        "status",
        "open",
        "prune",
        "verify",
        "tune",
        "cite",
    ):
        assert re.search(rf"^  {name} ", output, re.MULTILINE), name
        assert type_(f"{name} --help")[0] == 0
