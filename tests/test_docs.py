"""What README and docs/ name is there: pages, pictures, files, names of granstudy, fields, figures."""

import importlib
import re
from pathlib import Path

import pytest
import yaml

import granstudy as gs

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]

FOLDERS = "granstudy|tests|workflow|studies|notebooks|profiles|docs"

GONE = {"granstudy.compare"}
"""Names that the changelog says are no more."""


def parts(pattern, page):
    return sorted(set(re.findall(pattern, page.read_text(encoding="utf-8"))))


@pytest.fixture(params=PAGES, ids=lambda page: page.name)
def page(request):
    return request.param


def test_links_lead_somewhere(page):
    links = [link for link in parts(r"\]\(([^)#\s]*[./][^)#\s]*)", page) if "://" not in link]
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_links_to_headings_lead_somewhere(page):
    def anchors(path):
        headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.M)
        return {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}

    links = re.findall(r"\]\(([^)#\s]*)#([^)]+)\)", page.read_text(encoding="utf-8"))
    assert [
        (to, at) for to, at in links if at not in anchors(page.parent / (to or page.name))
    ] == []


def test_files_that_it_names_are_there(page):
    files = parts(rf"(?<![\w/.])(?:\.\./)?((?:{FOLDERS})/[\w./-]*\w)", page)
    written = "docs/_build/"  # by the commands on the pages
    missing = [file for file in files if not (ROOT / file).exists()]
    assert [file for file in missing if not file.startswith(written)] == []


def test_names_of_granstudy_that_it_mentions_exist(page):
    text = page.read_text(encoding="utf-8").replace("gs.", "granstudy.")
    names = set(re.findall(r"(?<![\w/.-])granstudy(?:\.[a-zA-Z_]\w*)+", text)) - GONE
    assert [name for name in sorted(names) if not exists(name)] == []


def exists(name):
    """Whether a dotted name is a module, or a name in one."""
    module, rest = name, []
    while True:
        try:
            found = importlib.import_module(module)
        except ModuleNotFoundError:
            module, _, last = module.rpartition(".")
            rest.insert(0, last)
            continue
        for part in rest:
            if not hasattr(found, part):
                return False
            found = getattr(found, part)
        return True


def test_readme_is_short():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 120


def test_readmes_study_is_the_one_that_granstudy_new_writes():
    (study,) = re.findall(
        r"^```yaml\n(.*?)^```", (ROOT / "README.md").read_text("utf-8"), re.M | re.S
    )
    template = ROOT / "granstudy" / "commands" / "templates" / "cooling.yaml"
    assert yaml.safe_load(study) == yaml.safe_load(template.read_text("utf-8"))


@pytest.mark.parametrize("name", ["fields", "gallery", "notebooks", "promises"])
def test_pages_that_are_written_are_due(name, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    written = importlib.import_module(f"write_{name}").page()
    said = (ROOT / "docs" / f"{name}.md").read_text("utf-8")
    assert said == written, f"write it anew: python docs/write_{name}.py"


def test_every_unit_and_text_of_the_fields_is_of_a_field(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    pages = importlib.import_module("write_fields")
    sections = pages.study_schema()["$defs"]
    assert [key for key in pages.UNITS if key[1] not in sections[key[0]]["properties"]] == []
    shown = {*pages.SECTIONS, *pages.EXPERIMENTS, *pages.SAME_AS}
    assert set(sections) - shown == set(), "sections of a study file that the page leaves out"


def test_the_page_of_python_has_every_public_name():
    page = (ROOT / "docs" / "api.md").read_text("utf-8")
    documented = re.findall(r"^\.\. auto(?:function|class):: (\w+)", page, re.M)
    listed = re.findall(r"`(\w+)`", "".join(re.findall(r"^\|.*$", page, re.M)))
    assert sorted([*documented, "theory"]) == sorted(dir(gs)) == sorted(listed)


def test_dir_gives_public_names_only():
    assert not [name for name in dir(gs) if name.startswith("_")]
    modules = [name for name in dir(gs) if type(getattr(gs, name)).__name__ == "module"]
    assert modules == ["theory"]


def test_the_pictures_of_notebooks_are_theirs(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    written = importlib.import_module("write_notebooks")
    for path in written.NOTEBOOKS:
        assert (written.PICTURES / f"{path.stem}.png").read_bytes() == written.picture(path)
