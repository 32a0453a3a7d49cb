"""A study's folder shows the study as it is now: names of runs, keys, jobs, labels."""

import json
from pathlib import Path

import pytest
from studies import load_text, replaced

from granstudy.runs.execute import obtain
from granstudy.runs.store import is_link
from granstudy.study.jobs import Job
from granstudy.study.layout import Layout
from granstudy.study.state import State, check_owner, labels, prepare, show
from granstudy.support.files import read_json

STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian2d, diffusion: 0.0}
    solver: {method: radial, N: 12, R: 7.0}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - e: [0.5, 0.7]
  again:
    title: the same gas under another name
    run: evolution
    scene: {name: maxwellian2d, e: 0.5, diffusion: 0.0}
    solver: {method: radial, R: 7.0}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - N: [12]
"""


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def layout(old="", new="", name="test"):
    return Layout(load_text(".", replaced(STUDY, old, new), name))


def compute(layout, count=None):
    """Compute missing runs into the store, as a job or a sweep does."""
    for same in State(layout).missing[:count]:
        obtain(same[0].run.computation, same[0].key, layout.store)


def names(layout):
    """Names of the runs in the study's folder."""
    runs = Path(layout.runs)
    return sorted(str(path.relative_to(runs).with_suffix("")) for path in runs.rglob("*.nc"))


ALL = ["again/N~12", "cooling/e~0.5", "cooling/e~0.7"]


def test_two_names_of_one_run_are_one_run():
    study = layout()
    assert len(study.study.members) == 3
    assert [len(same) for same in State(study).missing] == [2, 1]
    compute(study, 1)
    assert State(study).words() == {
        ("cooling", "e~0.5"): "done",
        ("cooling", "e~0.7"): "missing",
        ("again", "N~12"): "done",
    }
    assert State(study).seconds > 0.0


@pytest.mark.fault("A4")
def test_names_are_links_to_the_store_and_follow_the_study():
    study = layout()
    compute(study)
    show(State(study), "test.yaml")
    assert names(study) == ALL
    for m in study.study.members:
        target = Path(study.run_file(m.experiment, m.path))
        assert is_link(study.store.path(m.key), target) and Path(f"{target}.json").is_file()
    fewer = layout("e: [0.5, 0.7]", "e: [0.7]")
    show(State(fewer), "test.yaml")
    assert names(fewer) == ["again/N~12", "cooling/e~0.7"]
    assert not Path(f"{study.run_file('cooling', 'e~0.5')}.json").exists()
    assert len(study.store.keys()) == 2, "the run itself stays"
    none = layout("again:", "other:")
    show(State(none), "test.yaml")
    assert not Path(none.runs, "again").exists(), "an empty folder stays behind"
    assert names(none) == ["cooling/e~0.5", "cooling/e~0.7", "other/N~12"]


def test_a_run_whose_parameters_changed_loses_its_name_until_it_is_computed_anew():
    study = layout()
    compute(study)
    show(State(study), "test.yaml")
    longer = layout(
        "time: {t_final: 0.1, dt: 0.05}\n    sweep:\n      - e",
        "time: {t_final: 0.2, dt: 0.05}\n    sweep:\n      - e",
    )
    assert State(longer).words()["cooling", "e~0.7"] == "stale"
    show(State(longer), "test.yaml")
    assert names(longer) == ["again/N~12"]
    assert State(longer).words()["cooling", "e~0.7"] == "stale", "forgotten once it was shown"
    compute(longer)
    show(State(longer), "test.yaml")
    assert names(longer) == ALL and set(State(longer).words().values()) == {"done"}
    # What it was is still in the store: going back computes nothing.
    assert State(layout()).missing == []


def test_an_experiment_is_complete_while_all_its_runs_are_there():
    study = layout()
    compute(study, 1)
    show(State(study), "test.yaml")
    assert read_json(study.complete("again")).keys() == {"N~12"}
    assert not Path(study.complete("cooling")).exists()
    awaited = read_json(study.awaited("cooling"))
    compute(study)
    show(State(study), "test.yaml")
    assert read_json(study.complete("cooling")) == awaited
    written = Path(study.complete("cooling")).stat().st_mtime_ns
    show(State(study), "test.yaml")
    assert Path(study.complete("cooling")).stat().st_mtime_ns == written, "made the table again"
    study.store.remove(awaited["e~0.7"])
    show(State(study), "test.yaml")
    assert not Path(study.complete("cooling")).exists()


@pytest.mark.fault("B8")
def test_each_time_that_runs_go_missing_is_another_reason_to_compute():
    study = layout()
    since, found = Path(study.since("cooling")), []
    for _ in range(2):
        prepare(study, "test.yaml", cores=1)
        found.append(since.read_text())
        prepare(study, "test.yaml", cores=1)  # as a dry run does
        assert since.read_text() == found[-1]
        compute(study)
        prepare(study, "test.yaml", cores=1)
        study.store.remove(study.study.members[0].key)
    assert found[0] != found[1]


def test_jobs_are_written_and_forgotten_when_their_runs_are_there():
    study = layout()
    (job,) = prepare(study, "test.yaml", cores=1)
    assert Job.read(study.job_file(job.id)) == job and len(job.runs) == 3
    overview = read_json(study.overview)
    assert (overview["runs"], overview["done"], overview["cores"]) == (2, 0, 1)
    assert overview["seconds"] == pytest.approx(job.total)
    compute(study)
    Path(study.receipt(job.id)).write_text(json.dumps({job.runs[0][2]: "trusted"}))
    Path(study.jobs, f"{job.id}.progress.json").write_text("{}")
    assert prepare(study, "test.yaml", cores=1) == []
    assert not list(study.jobs.glob(f"{job.id}*"))
    assert read_json(study.labels)[job.runs[0][2]] == "trusted"
    overview = read_json(study.overview)
    assert overview["done"] == 2 and sum(overview["labels"].values()) == 2


@pytest.mark.fault("B8")
def test_a_receipt_whose_runs_are_gone_is_no_reason_to_leave_the_job_out():
    study = layout()
    (job,) = prepare(study, "test.yaml", cores=1)
    Path(study.receipt(job.id)).write_text("{}")
    (again,) = prepare(study, "test.yaml", cores=1)
    assert again == job and Path(study.job_file(job.id)).is_file()
    assert not Path(study.receipt(job.id)).exists()  # else Snakemake would take the job for done


def test_labels_are_counted_once_a_run_and_made_anew_where_they_are_lost():
    study = layout()
    compute(study)
    found = labels(State(study))
    assert sum(found.values()) == 2 and set(found) <= {"trusted", "marginal", "untrusted"}
    assert set(read_json(study.labels)) == {m.key for m in study.study.members}
    study.labels.write_text("not JSON")
    assert labels(State(study)) == found
    # The label in the file counts while it is there: it is not read again from the run.
    key = study.study.members[0].key
    study.labels.write_text(json.dumps(read_json(study.labels) | {key: "failed"}))
    assert labels(State(study))["failed"] == 1


def test_a_study_file_owns_its_folder_until_it_is_gone():
    study = layout()
    show(State(study), "test.yaml")
    Path("sub").mkdir()
    Path("sub/test.yaml").write_text(STUDY)
    check_owner(study, "test.yaml")
    check_owner(study, Path("sub/../test.yaml"))
    with pytest.raises(
        ValueError, match=r"sub/test.yaml: results/test holds the results of another"
    ):
        check_owner(study, "sub/test.yaml")
    with pytest.raises(ValueError, match="study 'test': results/test holds the results of"):
        check_owner(study, None)
    Path("test.yaml").unlink()
    check_owner(study, "sub/test.yaml")
    check_owner(study, None)


def test_a_renamed_study_finds_all_its_runs():
    study = layout()
    compute(study)
    show(State(study), "test.yaml")
    renamed = layout(name="renamed")
    assert State(renamed).missing == [] and prepare(renamed, "renamed.yaml", cores=2) == []
    assert names(renamed) == ALL == names(study)
