"""The benchmark of GPUs, NumPy in CuPy's place."""

import importlib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from devices import NUMPY

from granstudy.collision.fast.gpu.device import LIBRARIES

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


class Held:
    """Memory of a device that has none of its own."""

    def __init__(self, library):
        self.peak_mb = 5.0


@pytest.fixture
def gpu(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    script = importlib.import_module("gpu")
    monkeypatch.setitem(LIBRARIES, "CuPy", lambda: NUMPY)
    monkeypatch.setitem(LIBRARIES, "PyTorch", lambda: None)
    monkeypatch.setattr(script, "Memory", Held)
    monkeypatch.setattr(script, "peak_memory_mb", lambda scene, solver: 7.0)
    monkeypatch.setattr(script, "BATCHES", (2**20, 2**22))
    monkeypatch.setattr(script, "PATIENCE", 0.01)
    return script


def run(gpu, folder, *options):
    status = gpu.main([str(folder), "--no-tests", "--sizes", "8", "6", *options])
    return status, pd.read_csv(folder / "gpu.csv"), (folder / "gpu.md").read_text()


def test_every_case_has_a_line(gpu, tmp_path, monkeypatch):
    monkeypatch.setattr(gpu, "RULES", {"30 x 38": gpu.FIXED})
    status, rows, text = run(gpu, tmp_path, "--minutes", "5")
    assert status == 0 and rows["note"].isna().all()
    assert rows["N"].tolist() == sorted(rows["N"][rows["batch_mb"].isna()]) + 2 * [6] + 2 * [8]
    places = set(rows["where"])
    assert "CuPy" in places and any(where.startswith("CPU") for where in places)
    for precision, largest in gpu.EQUAL.items():
        on_gpu = rows[(rows["where"] == "CuPy") & (rows["precision"] == precision)]
        difference = on_gpu["difference"][on_gpu["batch_mb"].isna()]
        assert len(difference) == 2 and (difference <= largest).all()
    assert (rows["seconds"] > 0).all()
    assert (rows["memory_mb"][rows["where"] == "CuPy"] == 5.0).all()
    assert "PyTorch: finds no GPU" in text and "Not measured" not in text
    assert text.count("\n|   8 |") == 4


def test_a_failure_is_said_and_costs_no_other_line(gpu, tmp_path):
    status, rows, text = run(gpu, tmp_path, "--minutes", "5")
    failed = rows["note"].str.startswith("failed: ToleranceError", na=False)
    assert status == 1
    assert (failed == (rows["rule"] == "rtol=1e-3")).all()
    assert (rows["seconds"].isna() == failed).all()
    assert "CuPy, N = 8, rtol=1e-3, single: failed: ToleranceError" in text


def test_what_time_does_not_allow_is_said(gpu, tmp_path):
    _, rows, text = run(gpu, tmp_path, "--minutes", "0")
    assert rows["note"].str.startswith("left out").all() and rows["seconds"].isna().all()
    assert {6, 8} == set(rows["N"]) and "CuPy, N = 8, 30 x 38, double: left out" in text


@pytest.mark.parametrize("wrong", [1e-3, np.nan])
def test_a_wrong_Q_is_an_error(gpu, tmp_path, monkeypatch, wrong):
    measure = gpu.measure

    def spoiled(row, plan, device, f):
        row, Q = measure(row, plan, device, f)
        if device is not None:
            Q[0, 0, 0] = wrong
        return row, Q

    monkeypatch.setattr(gpu, "RULES", {"30 x 38": gpu.FIXED})
    monkeypatch.setattr(gpu, "measure", spoiled)
    assert run(gpu, tmp_path, "--minutes", "5")[0] == 1


def test_without_a_GPU_the_status_says_so(gpu, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(gpu, "RULES", {"30 x 38": gpu.FIXED})
    status, rows, _ = run(gpu, tmp_path, "--minutes", "5", "--libraries", "PyTorch")
    assert status == 1 and "no GPU" in capsys.readouterr().out
    assert rows["where"].str.startswith("CPU").all()
