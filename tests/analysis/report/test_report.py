"""The report of a study: all that the study asks for is in it, and nothing is fetched from elsewhere."""

import base64
import json
import re
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from browser import find_browser, looked_at

from granstudy.analysis.figures.figure import draw, save_figure
from granstudy.analysis.report.facts import computed_by, run_facts
from granstudy.analysis.report.markup import html_of, label_in
from granstudy.analysis.report.page import write_report
from granstudy.analysis.tables.table import KINDS, experiment_table, write_table
from granstudy.datasets.collected import gather
from granstudy.datasets.netcdf import read_dataset
from granstudy.study.layout import Layout
from granstudy.study.state import State, prepare, show
from granstudy.study.study import load_study
from granstudy.study.work import work
from granstudy.support.files import read_json

XHTML = "{http://www.w3.org/1999/xhtml}"

STUDY = """
title: Gases <of> two kinds & more
experiments:
  cooling:
    title: "a2 < 0 & T, by N"
    run: evolution
    scene: {name: maxwellian2d, e: 0.5, exponent: 1.0, diffusion: 0.0}
    solver: {R: 7.0, method: radial}
    time: {t_final: 4.0, dt: 0.1}
    sweep:
      - {N: [8, 24]}
    table: {quantity: a2}
    figure: {kind: quantity}
  steps:
    title: Steps that are too large
    run: evolution
    scene: {name: bkw2d, e: 0.5}
    solver: {R: 7.8, N_rho: 8, M_cir: 8, N: 12, method: literal}
    time: {t_final: 20.0}
    sweep:
      - {dt: [0.5]}
    table: {quantity: temperature}
"""


def made(folder, text, name):
    """A study, computed, with its tables and figures."""
    file = folder / f"{name}.yaml"
    file.write_text(text)
    layout = Layout(load_study(file), str(folder / "results"))
    for job in prepare(layout, file, 1):
        work(job, layout, 1, layout.receipt(job.id))
    show(State(layout), file)
    for one, experiment in layout.study.model.experiments.items():
        keys = read_json(layout.complete(one))
        gather({key: layout.run_file(one, path) for path, key in keys.items()}, layout.dataset(one))
        table = experiment_table(experiment, layout.study.runs[one], layout.run_files(one))
        write_table(table, *(layout.table_file(one, form) for form in ("nc", "csv", "md")))
        if experiment.figure is not None:
            figure = draw(experiment, table, layout.run_files(one), (), layout.study.runs[one])
            save_figure(figure, *(layout.figure_file(one, form) for form in ("png", "svg")))
    return layout, file


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return made(tmp_path_factory.mktemp("study"), STUDY, "gases")


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A study of which no run failed."""
    text = STUDY[: STUDY.index("  steps:")].replace("[8, 24]", "[24]")
    return made(tmp_path_factory.mktemp("sound"), text, "sound")


def written(study):
    layout, file = study
    write_report(layout, file, layout.report)
    return Path(layout.report)


def tree(page):
    """The page, which is strict XML, so that every element is closed and every sign escaped."""
    return ET.parse(page).getroot()


def texts(element):
    return " ".join("".join(element.itertext()).split())


def test_every_link_leads_somewhere_in_the_page_and_nothing_is_fetched(study):
    root = tree(written(study))
    identities = [one.get("id") for one in root.iter() if one.get("id")]
    assert len(set(identities)) == len(identities)
    links = [one.get("href") for one in root.iter(f"{XHTML}a")]
    assert {link[1:] for link in links if link.startswith("#")} <= set(identities)
    assert all(link.startswith(("#", "data:text/csv")) for link in links)
    assert {"#cooling", "#steps", "#runs", "#early", "#provenance"} <= set(links)
    for one in root.iter():
        assert one.tag not in {f"{XHTML}script", f"{XHTML}link", f"{XHTML}iframe"}
        assert one.get("src", "data:").startswith("data:")
    style = texts(next(root.iter(f"{XHTML}style")))
    assert "url(" not in style and "@import" not in style


def test_all_that_the_study_asks_for_is_there(study):
    layout, file = study
    root = tree(written(study))
    assert texts(next(root.iter(f"{XHTML}h1"))) == "Gases <of> two kinds & more"
    parts = {one.get("aria-labelledby"): one for one in root.iter(f"{XHTML}section")}
    (image,) = parts["cooling"].iter(f"{XHTML}img")
    content = base64.b64decode(image.get("src").partition(",")[2])
    assert content == Path(layout.figure_file("cooling", "svg")).read_bytes()
    assert "a2 < 0 & T, by N. Kurtosis excess over time." in image.get("alt")
    for name in ("cooling", "steps"):
        (address,) = [a.get("href") for a in parts[name].iter(f"{XHTML}a")]
        assert (
            base64.b64decode(address.partition(",")[2])
            == Path(layout.table_file(name, "csv")).read_bytes()
        )
        (table,) = parts[name].iter(f"{XHTML}table")
        lines = [texts(row).split() for row in table.iter(f"{XHTML}tr")]
        markdown = KINDS["evolution"].markdown(read_dataset(layout.table_file(name)))
        cells = [line.replace("|", " ").split() for line in markdown.splitlines() if "|" in line]
        assert lines == [cells[0], *cells[2 : 1 + len(lines)]]
        assert "Held fixed: " in texts(parts[name])
    assert "kurtosis excess" in texts(next(parts["cooling"].iter(f"{XHTML}dl")))
    assert file.read_text().strip() in "".join(parts["study-file"].itertext())
    assert "HuMa2019" in texts(parts["provenance"])
    (commit,) = computed_by(layout, ["cooling"])[1] or [""]
    assert commit in texts(parts["provenance"])
    for key in read_json(layout.complete("cooling")).values():
        assert key in texts(parts["runs"])


def test_labels_are_seen_counted_and_explained(study):
    layout, _ = study
    facts = {run.name: run for name in ("cooling", "steps") for run in run_facts(layout, name)}
    assert (facts["N~8"].label, facts["N~24"].label) == ("untrusted", "trusted")
    assert facts["dt~0.5"].status == "diverged" and facts["dt~0.5"].label == "failed"
    assert all(run.seconds > 0 for run in facts.values())
    root = tree(written(study))
    parts = {one.get("aria-labelledby"): one for one in root.iter(f"{XHTML}section")}
    rows = [one for one in parts["cooling"].iter(f"{XHTML}tr") if one.get("class")]
    assert [(texts(row)[:2].strip(), row.get("class")) for row in rows] == [
        ("8", "of-untrusted"),
        ("24", "of-trusted"),
    ]
    badges = {one.get("class"): texts(one) for one in root.iter(f"{XHTML}li") if one.get("class")}
    assert badges == {
        "trusted": "1 trusted", "marginal": "0 marginal", "untrusted": "1 untrusted", "failed": "1 failed",
    }  # fmt: skip
    assert facts["N~8"].reasons[0] in texts(parts["runs"])
    assert facts["dt~0.5"].reasons[0] in texts(parts["early"])


def test_a_study_without_failures_has_no_section_of_them(sound):
    root = tree(written(sound))
    assert not [one for one in root.iter() if one.get("id") == "early"]
    assert "failed" not in texts(next(root.iter(f"{XHTML}header")))
    assert {one.get("class") for one in root.iter(f"{XHTML}tr")} == {None, "of-trusted"}


def test_the_same_results_give_the_same_bytes_elsewhere_too(sound, tmp_path):
    layout, file = sound
    first = written(sound).read_bytes()
    assert written(sound).read_bytes() == first
    shutil.copytree(layout.folder, tmp_path / "results")
    shutil.copy(file, tmp_path)
    other = Layout(layout.study, str(tmp_path / "results"))
    write_report(other, tmp_path / file.name, other.report)
    assert Path(other.report).read_bytes() == first
    assert str(Path(layout.folder).parent).encode() not in first


def test_what_was_not_made_is_named(sound, tmp_path):
    layout, file = sound
    shutil.copytree(layout.folder, tmp_path / "results")
    other = Layout(layout.study, str(tmp_path / "results"))
    for form in ("png", "svg"):
        Path(other.figure_file("cooling", form)).unlink()
    write_report(other, file, other.report)
    assert "figure cooling: not made" in texts(tree(other.report))
    Path(other.table_file("cooling")).unlink()
    Path(other.dataset("cooling")).unlink()
    write_report(other, file, other.report)
    assert "table cooling: not made" in texts(tree(other.report))


def test_a_page_for_each_table_stands_alone(study, tmp_path):
    layout, file = study
    write_report(layout, file, layout.report, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"cooling.html", "steps.html"}
    root = tree(tmp_path / "steps.html")
    assert "diverged" in texts(next(root.iter(f"{XHTML}table")))


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ("trusted", "trusted"),
        ("0.0415 (untrusted)", "untrusted"),
        ("untrusted (wrong)", "untrusted"),
        ("diverged", "diverged"),
        ("0.0415", ""),
        ("a trusted friend", ""),
        ("not trusted", ""),
    ],
)
def test_labels_are_found_in_cells(text, label):
    assert label_in(text) == label


def test_texts_cannot_become_elements():
    html = html_of("# title\n\n| a | b |\n|:--|--:|\n| <b>x</b> | ok |\n\n<script>1</script>\n")
    assert "<script>" not in html and "<b>" not in html and "title" not in html
    ET.fromstring(f"<div>{html}</div>")


@pytest.mark.slow
@pytest.mark.skipif(find_browser() is None, reason="no Chromium is found")
@pytest.mark.parametrize(("width", "dark"), [(1200, False), (1200, True), (360, False)])
def test_a_browser_shows_it(study, tmp_path, width, dark):
    """All pictures are seen, nothing is fetched, a narrow screen is enough, and dark is dark."""
    options = [f"--window-size={width},900"]
    options += ["--blink-settings=preferredColorScheme=0"] if dark else []
    seen = json.loads(looked_at(find_browser(), written(study), *options, folder=tmp_path))
    assert (seen["images"], seen["broken"], seen["fetched"]) == (1, 0, 0)
    assert seen["too_wide"] <= 0
    ground, text = (
        sum(map(int, re.findall(r"\d+", seen[name])[:3])) for name in ("ground", "text")
    )
    assert (ground < text) == dark
