"""Results of one study file are not mixed with another's."""

from pathlib import Path

import pytest
from studies import load_text

from granstudy.study.layout import Layout
from granstudy.study.state import check_owner
from granstudy.support.files import write_json

STUDY = """
title: mine
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, e: 0.5}
    solver: {R: 7.0, N: 8, method: radial}
    time: {t_final: 1.0}
    sweep:
      - {dt: [0.5, 0.25]}
"""


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A checkout with a shipped study quick, which is the working folder."""
    shipped = tmp_path / "workflow" / "config"
    shipped.mkdir(parents=True)
    (shipped / "quick.yaml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.fault("C4")
def test_a_study_named_like_a_shipped_one_takes_another_name_or_folder(checkout):
    own = Layout(load_text(checkout, STUDY, "quick"))
    with pytest.raises(
        ValueError, match="quick.yaml: results/quick holds .*another name.*--config res"
    ):
        check_owner(own, checkout / "quick.yaml")
    check_owner(Layout(own.study, "mine"), checkout / "quick.yaml")
    check_owner(Layout(load_text(checkout, STUDY, "other")), checkout / "other.yaml")


def test_the_shipped_study_keeps_its_name(checkout):
    path = Path("workflow/config/quick.yaml")
    check_owner(Layout(load_text(path.parent, STUDY, "quick")), path)


def test_two_files_of_one_name_do_not_share_results(checkout):
    study = load_text(checkout, STUDY, "own")
    other = checkout / "elsewhere" / "own.yaml"
    other.parent.mkdir()
    other.write_text(STUDY)
    layout = Layout(study)
    write_json(layout.manifest, {"file": str(other)})
    with pytest.raises(
        ValueError, match="results/own holds the results of another study, .*elsewhere"
    ):
        check_owner(layout, checkout / "own.yaml")
    other.unlink()
    check_owner(layout, checkout / "own.yaml")


def test_a_folder_of_results_has_no_braces(checkout):
    layout = Layout(load_text(checkout, STUDY, "own"), "res{x}")
    with pytest.raises(ValueError, match="results='res{x}': must have no braces"):
        check_owner(layout, checkout / "own.yaml")


@pytest.mark.fault("C4")
def test_a_study_called_paper_has_no_notebooks_of_runs_that_it_lacks(tmp_path):
    assert Layout(load_text(tmp_path, STUDY, "paper"), str(tmp_path)).notebooks == []


@pytest.mark.fault("C4")
@pytest.mark.parametrize("name", ["my{s}", "my study", ".hidden", "it's", "x" * 65, "-x"])
def test_names_of_study_files(tmp_path, name):
    with pytest.raises(ValueError, match="is no name of a study, whose results lie in a folder"):
        load_text(tmp_path, STUDY, name)
    assert load_text(tmp_path, STUDY, "my_2nd-study.v1").name == "my_2nd-study.v1"
