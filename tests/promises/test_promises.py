"""A few trials of each attack; the whole of them is in docs/promises.md."""

import pytest

from promises import damage, full_disks, kills, study_files, writers
from promises.trial import finished


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The attacked study, computed and left alone."""
    return finished(tmp_path_factory.mktemp("reference"))


@pytest.mark.parametrize("seed", range(3))
def test_a_killed_study_goes_on_with_the_same_bytes(seed, tmp_path, reference):
    trial = kills.trial(seed, tmp_path, reference)
    assert trial.kept, trial.outcome


@pytest.mark.parametrize("seed", range(4))
def test_a_full_disk_leaves_nothing_half_written(seed, tmp_path, reference):
    if not full_disks.can_mount(tmp_path):
        pytest.skip("this user may not mount a disk in memory")
    trial = full_disks.trial(seed, tmp_path, reference)
    assert trial.kept, trial.outcome


@pytest.mark.parametrize("seed", range(12))
def test_damage_is_noticed_and_healed(seed, tmp_path, reference):
    trial = damage.trial(seed, tmp_path, reference)
    assert trial.kept, trial.outcome


@pytest.mark.parametrize("seed", range(2))
def test_concurrent_writers_make_the_same_bytes(seed, tmp_path, reference):
    trial = writers.trial(seed, tmp_path, reference)
    assert trial.kept, trial.outcome


def test_a_broken_promise_is_seen(tmp_path, reference, monkeypatch):
    monkeypatch.setattr(damage, "compute", _nothing)
    assert not damage.trial(0, tmp_path, reference).kept


def _nothing(folder):
    """What a command does that heals nothing."""


def test_a_study_file_is_planned_or_refused(tmp_path):
    assert study_files.trial(0, tmp_path, None).kept
