"""CITATION.cff, `granstudy cite`, and the package say the same of what to cite."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

import granstudy as gs
from granstudy.commands.main import granstudy

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


@pytest.fixture(scope="module")
def cff():
    return yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))


@pytest.fixture(scope="module")
def bibtex():
    """Entries of `granstudy cite`: field ↦ value without braces, by kind."""
    output = CliRunner().invoke(granstudy, ["cite"]).output
    found = {}
    for kind, body in re.findall(r"@(\w+)\{(.*?)^\}", output, re.M | re.S):
        fields = re.findall(r"(\w+)\s*=\s*\{(.*?)\},?\s*$(?=\s*\w+\s*=|\s*\Z)", body, re.M | re.S)
        found[kind] = {name: " ".join(re.sub("[{}]", "", text).split()) for name, text in fields}
    return found


def test_the_software(cff, bibtex):
    software = bibtex["software"]
    assert cff["title"] == software["title"] and cff["license"] == software["license"]
    assert cff["license"] == PROJECT["license"]
    assert cff["version"] == gs.__version__ == software["version"]
    assert [author["name"] for author in cff["authors"]] == [software["author"]]


def test_the_paper(cff, bibtex):
    (paper,), article = cff["references"], bibtex["article"]
    assert paper["title"] == article["title"] and paper["doi"] == article["doi"]
    assert paper["journal"] == article["journal"]
    names = [f"{author['family-names']}, {author['given-names']}" for author in paper["authors"]]
    assert " and ".join(names) == article["author"]
    assert f"{paper['start']}--{paper['end']}" == article["pages"]
    assert [str(paper[name]) for name in ("volume", "year")] == [article["volume"], article["year"]]


def test_the_version_stands_in_one_place():
    assert "version" in PROJECT["dynamic"] and "version" not in PROJECT
    assert re.fullmatch(r"\d+\.\d+\.\d+", gs.__version__)
