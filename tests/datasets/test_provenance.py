"""A run names the commit of granstudy's own checkout, or none."""

import subprocess

import pytest

from granstudy.datasets.run_dataset import commit_of


def git(folder, *words):
    command = ["git", "-c", "user.name=x", "-c", "user.email=x@x", *words]
    run = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    return run.stdout.strip()


@pytest.fixture
def repository(tmp_path):
    """A repository with a commit."""
    git(tmp_path, "init", "-q")
    git(tmp_path, "commit", "-q", "--allow-empty", "-m", "first")
    return tmp_path


@pytest.mark.fault("A10")
def test_a_package_inside_another_repository_names_no_commit(repository):
    installed = repository / ".venv/lib/python3.11/site-packages"
    installed.mkdir(parents=True)
    assert commit_of(installed) == ""
    assert commit_of(repository) == git(repository, "rev-parse", "HEAD")


@pytest.mark.fault("A10")
def test_what_git_sets_for_hooks_names_no_other_repository(
    repository, tmp_path_factory, monkeypatch
):
    outside = tmp_path_factory.mktemp("outside")
    monkeypatch.setenv("GIT_DIR", str(repository / ".git"))
    monkeypatch.setenv("GIT_WORK_TREE", str(outside))
    assert commit_of(outside) == ""


@pytest.mark.fault("A10")
def test_a_repository_without_a_commit_and_a_folder_that_is_gone(tmp_path):
    git(tmp_path, "init", "-q")
    assert commit_of(tmp_path) == "" and commit_of(tmp_path / "gone") == ""
