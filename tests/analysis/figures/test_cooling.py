"""Cooling over decades: the table's slope against Haff's law, and what the figure draws."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.datasets.netcdf import run_seconds
from granstudy.reading.cooling import local_slope

STUDY = """
title: decades
experiments:
  haff:
    title: haff
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {N: 16, R: 7.0, method: radial}
    time: {t_final: 1.0e+5, time_rtol: 1.0e-5, frame: rescaled, times: {first: 0.1, per_decade: 5}}
    sweep:
      - {e: [0.5, 0.8]}
    table: {quantity: temperature}
    fit: {law: slope}
    figure: {kind: slope}
"""


def test_the_slope_of_the_last_decade(made):
    table, files = made.tables["haff"], made.files["haff"]
    assert table["slope"].values == pytest.approx(-2.0, abs=1e-3)
    # the last decade begins at t = 10⁴, where Haff's law is 2/(C0 t) short of its limit
    runs = made.study.runs["haff"].values()
    K = [float(gs.cooling_state(r.scene, r.solver)["cooling_coefficient"]) for r in runs]
    at = 10**4.1
    assert table["slope_error"].values == pytest.approx([4 / (k * at) for k in K], rel=0.05)
    assert table["seconds"].values.tolist() == [run_seconds(file) for file in files]
    left, right = made.draw("haff").axes
    T = gs.open_runs(files)["temperature"].values[:, 1:]
    time = left.lines[0].get_xdata()
    for i in range(2):
        np.testing.assert_array_equal(left.lines[i].get_ydata(), T[i])
        distance = np.abs(local_slope(time, T[i])[1] + 2.0)
        np.testing.assert_array_equal(right.lines[i].get_ydata(), distance)
