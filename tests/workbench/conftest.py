"""Sweeps and studies in a folder of their own, their evaluations counted."""

import pytest

from granstudy.runs import execute


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """A folder to work in, with the results in it."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def computed(monkeypatch):
    """Computations that were made in this process, in their order."""
    made = []
    compute = execute.execute

    def counted(one, *more):
        made.append(one)
        return compute(one, *more)

    monkeypatch.setattr(execute, "execute", counted)
    return made
