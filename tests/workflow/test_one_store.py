"""A sweep begun in Python, stopped, continued by snakemake, extended, renamed: one run for each point."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from tiny_workflow import REPOSITORY

import granstudy as gs


@pytest.fixture(scope="module")
def one_store():
    """The script that does the same for 250 points."""
    path = REPOSITORY / "benchmarks/one_store.py"
    spec = importlib.util.spec_from_file_location("one_store", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_twenty_points_and_five_more_are_twenty_five_evaluations(one_store, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stopped, continued, extended, renamed, again = one_store.stages(tmp_path, points=20, more=5)
    assert 0 < stopped.computed < 20 and stopped.there == stopped.computed
    assert continued.computed == 20 - stopped.computed and continued.there == 20
    assert extended.computed == 5 and extended.there == 25
    assert renamed.computed == again.computed == 0 and again.there == 25
    # One dataset at the end, the same in the workflow's folder and in Python.
    assert one_store.runs_of_study(tmp_path) == 25
    ds = gs.open_study("renamed.yaml").dataset()
    assert ds["e"].values.tolist() == sorted(one_store.restitutions(20, 5))
    assert ds["temperature"].notnull().all() and np.unique(ds["run_key"]).size == 25
    assert not Path("mine.yaml").exists() and Path("results/renamed/tables/cooling.md").is_file()


def test_further_points_are_none_of_the_first(one_store):
    values = one_store.restitutions(200, 50)
    assert len(set(values)) == len(values) == 250 and min(values) >= 0.1 and max(values) <= 0.9
