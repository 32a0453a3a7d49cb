"""What the machine says of itself."""

import os

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import granstudy as gs
from granstudy.support import machine
from granstudy.support.machine import check_memory, cores, memory, one_blas_thread


@pytest.mark.fault("B12")
def test_cores_where_the_platform_does_not_say_which(monkeypatch):
    assert 1 <= cores() <= os.cpu_count()
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 6)
    assert cores() == 6
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert cores() == 1


def test_memory_is_the_groups_where_that_is_less(monkeypatch, tmp_path):
    whole = memory()
    monkeypatch.setattr(machine, "CGROUP", tmp_path)
    (tmp_path / "memory.max").write_text("max\n")
    assert memory() >= whole > 10**8
    (tmp_path / "memory.max").write_text("1000000\n")
    assert memory() == 10**6


def test_more_than_the_memory_is_refused(monkeypatch):
    monkeypatch.setattr(machine, "memory", lambda: 8 * 10**9)
    check_memory("N=128", 8e9, "take fewer")
    with pytest.raises(ValueError, match=r"N=512: takes about 64.1 GB .* 8 GB; take fewer"):
        check_memory("N=512", 64.12e9, "take fewer")
    monkeypatch.setattr(machine, "memory", lambda: None)
    check_memory("N=512", 64.12e9, "take fewer")


def blas_threads():
    """Threads of each BLAS library that this process has loaded."""
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


@pytest.fixture
def two_threads():
    with threadpool_limits(limits=2, user_api="blas"):
        yield blas_threads()


def test_blas_has_one_thread_while_a_run_computes(two_threads):
    if set(two_threads) != {2}:
        pytest.skip("this BLAS takes no two threads")
    seen = []
    scene = gs.load_scene("maxwellian2d")
    solver = gs.Solver(N=8, R=8.0, method="radial")

    def look(*progress):
        seen.append(blas_threads())

    for words in ({"solver": solver, "dt": 0.1}, {"accuracy": 1e-2}):
        gs.simulate(scene, t_final=0.2, progress=look, **words)
        assert seen and all(set(threads) == {1} for threads in seen)
        assert blas_threads() == two_threads
        seen.clear()


def test_blas_gets_its_threads_back_after_an_error(two_threads):
    with pytest.raises(KeyError), one_blas_thread():
        raise KeyError
    assert blas_threads() == two_threads
