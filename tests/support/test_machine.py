"""What the machine says of itself."""

import os

import pytest

from granstudy.support import machine
from granstudy.support.machine import check_memory, cores, memory


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
