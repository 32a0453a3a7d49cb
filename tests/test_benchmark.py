"""The benchmark's dataset: what is there, not how fast it is."""

import numpy as np

from granstudy.benchmark import benchmark
from granstudy.study import load_study

STUDY = """
title: speed
experiments:
  speed:
    title: speed
    run: benchmark
    scene: {name: bkw2d, restitution: 0.2}
    solver: {R: 7.0, N_rho: 4, M_cir: 4}
    sweep:
      - {N: [8], method: [direct, literal, fast, radial]}
"""


def test_every_method_is_timed_beside_literal_and_its_transforms(tmp_path, monkeypatch):
    monkeypatch.setattr("granstudy.benchmark.LEAST_SECONDS", 0.0)
    (tmp_path / "speed.yaml").write_text(STUDY)
    runs = list(load_study(tmp_path / "speed.yaml").runs["speed"].values())
    ds = benchmark(runs, threads=1)
    assert list(ds["method"].values) == ["direct", "literal", "fast", "radial"]
    assert np.all(ds["seconds"] > 0) and np.all(np.isfinite(ds["peak_memory_mb"]))
    # the scene has the square's symmetry: of four angles one is evaluated
    assert list(ds["transforms"].values) == [2, 35, 11, 0]
    np.testing.assert_allclose(ds["speedup"], float(ds["seconds"][1]) / ds["seconds"])
    assert np.all(np.isnan(ds["overhead"][[0, 3]])) and np.all(ds["overhead"][1:3] > 0)
