"""`granstudy prune` and `verify`."""

from pathlib import Path

import pytest
from gases import FAST, RADIAL, SHORT, my_gas, stored, sweep

import granstudy as gs


def compute(name="mine"):
    study = gs.open_study(f"{name}.yaml")
    study.compute(workers=1, progress=False)
    return study


def edit(old, new, name="mine"):
    path = Path(f"{name}.yaml")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_what_a_study_or_a_sweep_has_is_never_removed(type_, here):
    compute()
    sweep("bkw2d", RADIAL, over={"e": [0.5]}, **SHORT)
    sweep("bkw2d", RADIAL, over={"e": [0.6, 0.7]}, name="named", **SHORT)
    before = stored(here / "results")
    status, output = type_("prune --yes")
    assert status == 0 and "removed 0 runs" in output
    for line in (
        "study mine: 2 runs, kept",
        "sweep unnamed: 1 run, kept",
        "sweep named: 2 runs, kept",
    ):
        assert line in output
    assert stored(here / "results") == before and len(before) == 5


def test_what_nobody_has_is_listed_and_then_removed(type_, here):
    compute()
    edit("e: [0.5, 0.7]", "e: [0.7]")
    assert "no run is unused" in type_("prune")[1], "the study was not opened since the edit"
    gs.open_study("mine.yaml").show()
    status, output = type_("prune")
    assert status == 0 and "study mine: 1 run, kept" in output
    assert "no one has 1 run, 0.0 MB; --yes removes them" in output
    assert len(stored(here / "results")) == 2
    status, output = type_("prune --yes")
    assert status == 0 and "removed 1 run," in output and len(stored(here / "results")) == 1
    assert gs.open_study("mine.yaml").remaining.runs == 0


def test_a_renamed_study_and_a_sweep_are_given_up_by_name(type_, here):
    compute()
    Path("mine.yaml").rename("yours.yaml")
    edit("e: [0.5, 0.7]", "e: [0.5]", "yours")
    compute("yours")
    sweep("bkw2d", RADIAL, over={"e": [0.5, 0.6]}, name="old", **SHORT)
    assert "no run is unused" in type_("prune")[1]
    status, output = type_("prune --give-up 'study mine' --give-up 'sweep old'")
    assert status == 0 and "no one has 3 runs" in output and len(stored(here / "results")) == 4
    status, output = type_("prune --yes --give-up 'study mine' --give-up 'sweep old'")
    assert status == 0 and "removed 3 runs" in output and len(stored(here / "results")) == 1
    assert not list(Path("results/mine").rglob("*.nc")), "names keep the files on the disk"
    status, output = type_("prune")
    assert output == "study yours: 1 run, kept\nno run is unused\n"
    status, output = type_("prune --give-up 'study mine'")
    assert status == 1 and "no such study or sweep; there are study yours" in output


def test_an_empty_folder_has_nothing_to_prune(type_):
    assert type_("prune") == (0, "no run is unused\n")
    status, output = type_("prune --give-up x")
    assert status == 1 and "there are none" in output


def test_runs_that_are_computed_meanwhile_are_kept(type_, here, monkeypatch):
    """Another process prunes after each run of a sweep, and of a study."""
    from granstudy.runs.store import Store

    write, seen = Store.write, []

    def write_and_prune(self, *run):
        write(self, *run)
        seen.append(type_("prune --yes")[1])

    monkeypatch.setattr(Store, "write", write_and_prune)
    compute()
    sweep("bkw2d", RADIAL, over={"e": [0.5, 0.6]}, **SHORT)
    assert len(seen) == 4 and all("removed 0 runs" in text for text in seen)
    assert len(stored(here / "results")) == 4


# verify


@pytest.fixture
def files():
    """Files of two runs, under the study's names."""
    compute()
    return sorted(map(str, Path("results/mine/runs").rglob("*.nc")))


def test_runs_are_the_same_bit_for_bit(type_, files):
    status, output = type_(f"verify {' '.join(files)}")
    assert status == 0
    assert output == "".join(f"{file}: the same bit for bit\n" for file in files)


def test_each_file_has_its_verdict(type_, files, here):
    good, changed = files
    ds = gs.read_dataset(changed).load()
    ds["a2"][-1] += 1e-3
    gs.write_dataset(ds, changed)
    Path("damaged.nc").write_bytes(Path(good).read_bytes()[:-1])
    gs.write_dataset(gs.simulate(gs.load_scene("bkw2d"), RADIAL, progress=False, **SHORT), "own.nc")
    status, output = type_(f"verify damaged.nc own.nc {changed} {good}")
    lines = output.splitlines()
    assert status == 1 and len(lines) == 4
    assert lines[0].startswith("damaged.nc: damaged: ")
    assert lines[1].startswith("own.nc: not verified: the dataset has no attribute 'parameters'")
    assert lines[2].startswith(f"{changed}: NOT the same: a2 differs by ")
    assert lines[3] == f"{good}: the same bit for bit"


def test_the_tolerance_says_what_counts_as_the_same(type_, files):
    ds = gs.read_dataset(files[0]).load()
    ds["temperature"][0] *= 1.0 + 1e-7
    gs.write_dataset(ds.assign_attrs(run_key="other"), files[0])
    assert type_(f"verify {files[0]}")[0] == 1
    status, output = type_(f"verify --tolerance 1e-6 {files[0]}")
    assert status == 0 and ": the same: temperature differs by 1.0e-07, the code changed" in output


def test_code_of_the_user_runs_only_when_told_to(type_, here):
    my_gas(here)
    sweep("my_gas.py:anisotropic", FAST, over={"ratio": [2.0]}, **SHORT)
    (file,) = Path("results/.runs").glob("??/*.nc")
    status, output = type_(f"verify {file}")
    assert status == 1 and "not verified: the dataset holds code of its user" in output
    assert type_(f"verify --run-code {file}") == (0, f"{file}: the same bit for bit\n")
