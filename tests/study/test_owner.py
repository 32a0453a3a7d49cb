"""Results of one study file are not mixed with another's."""

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
def folder(tmp_path, monkeypatch):
    """A folder that is the working one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_two_files_of_one_name_do_not_share_results(folder):
    study = load_text(folder, STUDY, "own")
    other = folder / "elsewhere" / "own.yaml"
    other.parent.mkdir()
    other.write_text(STUDY)
    layout = Layout(study)
    write_json(layout.manifest, {"file": str(other)})
    with pytest.raises(
        ValueError, match="results/own holds the results of another study, .*elsewhere"
    ):
        check_owner(layout, folder / "own.yaml")
    other.unlink()
    check_owner(layout, folder / "own.yaml")


def test_a_folder_of_results_has_no_braces(folder):
    layout = Layout(load_text(folder, STUDY, "own"), "res{x}")
    with pytest.raises(ValueError, match="results='res{x}': must have no braces"):
        check_owner(layout, folder / "own.yaml")


@pytest.mark.fault("C4")
def test_a_study_called_paper_has_no_notebooks_of_runs_that_it_lacks(tmp_path):
    assert Layout(load_text(tmp_path, STUDY, "paper"), str(tmp_path)).notebooks == []


@pytest.mark.fault("C4")
@pytest.mark.parametrize("name", ["my{s}", "my study", ".hidden", "it's", "x" * 65, "-x"])
def test_names_of_study_files(tmp_path, name):
    with pytest.raises(ValueError, match="is no name of a study, whose results lie in a folder"):
        load_text(tmp_path, STUDY, name)
    assert load_text(tmp_path, STUDY, "my_2nd-study.v1").name == "my_2nd-study.v1"
