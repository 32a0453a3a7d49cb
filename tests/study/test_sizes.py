"""Sizes that a machine cannot hold are refused by arithmetic alone."""

import tracemalloc

import pytest

from granstudy.study import sizes

STUDY = """
title: sizes
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0}
    solver: {R: 7.0, N: 64, N_rho: 30, M_sph: 32}
    time: {t_final: 1.0, dt: 0.1}
    sweep:
      - {e: [0.2, 0.5]}
"""


def test_the_memory_of_the_machine_is_the_limit(load, monkeypatch):
    load()
    monkeypatch.setenv(sizes.MEMORY, "0.25")
    message = "N=64, method='fast': the run would take 0.[0-9] GB; this machine has 0.2 GB .set GRANSTUDY_MEM"
    with pytest.raises(ValueError, match=message):
        load()
    monkeypatch.delenv(sizes.MEMORY)
    assert 256 < sizes.machine_memory_mb() < 2**24


@pytest.mark.parametrize("said", ["", "much", "-1", "0", "nan", "inf"])
def test_a_stated_memory_is_a_positive_number(said, monkeypatch):
    monkeypatch.setenv(sizes.MEMORY, said)
    with pytest.raises(ValueError, match=f"{sizes.MEMORY}='{said}': must be a positive number"):
        sizes.machine_memory_mb()


@pytest.mark.fault("C3")
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("N: 64", "N: 20000", "N=20000, method='fast': the run would take 596,046"),
        ("N: 64", "N: 20000, particles: 1000", "the run would take|only method 'dsmc'"),
        ("dt: 0.1}", "dt: 2.0e-9}", "dt=2e-09: t_final=1.0 would take more than 100,000,000 steps"),
        ("dt: 0.1}", "dt: 2.0e-8}", "the run would take .* GB"),
        ("M_sph: 32", "M_sph: 1000000", "M_sph=1000000: must be 100,000 at most"),
    ],
)
def test_nothing_of_the_size_is_made(load, monkeypatch, old, new, message):
    monkeypatch.setenv(sizes.MEMORY, "16")
    load()
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=message):
            load(old, new)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 20 * 2**20
