"""A table is made of the runs that the study names, whole; any other file is removed, and computed anew."""

import os
from pathlib import Path

import pytest
from studies import load_text

from granstudy.datasets.netcdf import read_dataset
from granstudy.runs.execute import obtain
from granstudy.study.healing import healed
from granstudy.study.layout import Layout
from granstudy.study.state import State, prepare

STUDY = """
title: test
experiments:
  collision:
    title: collisions
    run: collision
    scene: {name: maxwellian2d, diffusion: 0.0}
    solver: {N: 8, R: 7.0, N_rho: 4, M_cir: 4, method: literal}
    reference: {M_cir: 8}
    sweep:
      - e: [0.5, 0.7]
    table: {quantity: collision_error}
"""


@pytest.fixture
def layout(tmp_path, monkeypatch):
    """A study whose runs are all there."""
    monkeypatch.chdir(tmp_path)
    found = Layout(load_text(".", STUDY, "test"))
    compute(found)
    return found


def compute(layout):
    """What the next `snakemake` does: compute what is missing, and name the runs."""
    for same in State(layout).missing:
        obtain(same[0].run.computation, same[0].key, layout.store)
    prepare(layout, "test.yaml", 1)


def copied(source, target):
    """Write one file's bytes into another, and put its size and times back."""
    before = os.stat(target)
    Path(target).write_bytes(Path(source).read_bytes())
    os.utime(target, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert os.stat(target).st_size == before.st_size


def contents(layout):
    return {file: Path(file).read_bytes() for file in layout.run_files("collision")}


@pytest.mark.fault("A6")
def test_the_file_of_another_run_is_removed_and_computed_anew(layout):
    before = contents(layout)
    one, other = (f for f in layout.run_files("collision") if "reference" not in f)
    copied(one, other)  # the name in the study's folder and the one in the store are one file
    told = r"1 runs were damaged, or files of other runs.*e~0.7"
    with pytest.raises(ValueError, match=told), healed(layout, "collision"):
        pytest.fail("a table is made of two runs of one key")
    compute(layout)
    assert contents(layout) == before
    with healed(layout, "collision"):
        pass


@pytest.mark.fault("A6")
def test_a_file_that_lies_in_the_place_of_a_name_gives_way_to_the_run_in_the_store(layout):
    before = contents(layout)
    one, other = (f for f in layout.run_files("collision") if "reference" not in f)
    times = os.stat(other)
    Path(other).unlink()
    Path(other).write_bytes(before[one])
    os.utime(other, ns=(times.st_atime_ns, times.st_mtime_ns))
    with healed(layout, "collision"):
        assert contents(layout) == before


@pytest.mark.fault("B6", "B8")
@pytest.mark.parametrize("place", [0.5, 0.9])
def test_damage_is_found_where_it_is_read_and_healed(layout, place):
    before = contents(layout)
    file = Path(layout.run_files("collision")[0])
    data = bytearray(file.read_bytes())
    data[int(place * len(data))] ^= 1
    file.write_bytes(data)
    told = r"1 runs were damaged.*computes them anew"
    with pytest.raises(ValueError, match=told), healed(layout, "collision"):
        for each in layout.run_files("collision"):
            read_dataset(each)
    compute(layout)
    assert contents(layout) == before


def test_an_error_that_is_not_damage_of_runs_stays(layout):
    with pytest.raises(ZeroDivisionError), healed(layout, "collision"):
        raise ZeroDivisionError
