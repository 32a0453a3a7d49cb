"""Every fault that was found once has a test that keeps it from coming back (tests/faults.toml)."""

import importlib
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture
def pages(monkeypatch):
    """What writes the page that lists the faults and their tests."""
    monkeypatch.syspath_prepend(str(DOCS))
    return importlib.import_module("write_promises")


def test_every_fault_has_a_test_and_every_name_is_known(pages):
    tests, known = pages.marked(), pages.faults()
    assert [name for name in known if name not in tests] == []
    assert {name: found for name, found in tests.items() if name not in known} == {}
    functions = [test.split("::")[1] for found in tests.values() for test in found]
    assert [name for name in functions if not name.startswith("test_")] == []


def test_a_fault_is_said_in_one_sentence(pages):
    for name, said in pages.faults().items():
        assert said.endswith(".") and "\n" not in said and len(said) < 130, name
