"""The workflow on a Slurm cluster of one node; by `literal`, as nothing of it has to be compiled."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from slurm_cluster import CannotStartError, slurm_cluster

from granstudy import read_dataset
from granstudy.analysis.compare import Grade, compare_folders

REPOSITORY = Path(__file__).parents[2]

EXPERIMENT = """
  {name}:
    title: "convergence in N"
    run: evolution
    scene: {{name: bkw2d}}
    solver: {{R: 7.8, N_rho: 8, M_cir: 8, method: literal}}
    threads: {threads}
    time: {{t_final: {t_final}, dt: 0.05}}
    sweep:
      - {{e: {e}, N: {N}}}
    table: {{quantity: paper_temperature_error}}
    figure: {{kind: convergence, x: N}}
"""

SMALL = "title: small\nexperiments:" + "".join(
    EXPERIMENT.format(name=name, e=e, threads=threads, N="[8, 10, 12]", t_final=0.1)
    for name, e, threads in (("inelastic", "[0.2, 0.5]", 1), ("sticky", "[0.0, 0.01]", 2))
)
"""Twelve cheap runs in two jobs, which take different numbers of cores."""

SLOW = "title: slow\nexperiments:" + EXPERIMENT.format(
    name="slow", e="[0.5]", threads=1, N="[8, 128]", t_final=6.0
)
"""One job: a run of a moment, then one that takes a while."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def cluster():
    pytest.importorskip(
        "snakemake_executor_plugin_slurm", reason="no plugin: pip install '.[slurm]'"
    )
    try:
        with slurm_cluster() as started:
            yield started
    except CannotStartError as error:
        pytest.skip(f"no Slurm: {error}")


@pytest.fixture
def project(tmp_path):
    """A copy of what a clone holds, with the tests' studies."""
    for name in ("granstudy", "snakemake_logger_plugin_granstudy", "profiles"):
        shutil.copytree(
            REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__")
        )
    shutil.copy(REPOSITORY / "Snakefile", tmp_path)
    (tmp_path / "small.yaml").write_text(SMALL)
    (tmp_path / "slow.yaml").write_text(SLOW)
    return tmp_path


def start(project, environment, *arguments):
    # A shell that starts the tests in the background makes them, and all that they start, ignore Ctrl-C.
    heard = ["env", "--default-signal=INT"]
    return subprocess.Popen(
        [*heard, sys.executable, "-m", "snakemake", *arguments],
        cwd=project,
        env=environment | {"PYTHONPATH": str(project)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def submit(project, cluster, study, *arguments):
    """The command of docs/clusters.md; only the checks of jobs are more often than once a minute."""
    often = ["--slurm-init-seconds-before-status-checks", "3"]
    profile = ["--workflow-profile", "profiles/slurm", *often, *arguments]
    return start(project, cluster.environment, *profile, "--config", f"study={study}")


def finish(process, succeeds=True):
    output = process.communicate(timeout=600)[0]
    assert (process.returncode == 0) == succeeds, output
    return output


def wait_for(condition, process):
    """What `condition` returns once that is true; `process` must not end before."""
    deadline = time.monotonic() + 120
    while not (found := condition()):
        assert process.poll() is None, process.communicate()[0]
        assert time.monotonic() < deadline, "not within two minutes"
        time.sleep(0.2)
    return found


FIRST = "results/slow/runs/slow/e~0.5/N~8.nc"
"""Name of the slow job's first run."""


def first_computed(project):
    """When that run was computed: the file beside it is written then, and never again."""
    return (project / f"{FIRST}.json").stat().st_mtime_ns


def receipts(project, study):
    """The jobs of a study that have computed all their runs, by their names on the cluster."""
    return [
        f"rule_run_{path.stem}" for path in (project / "results" / study / "jobs").glob("*.done")
    ]


def started_and_computing(project, cluster, *arguments):
    """A slow study on its way: its process, and its job once that is in its second run."""
    before = cluster.jobs()
    process = submit(project, cluster, "slow.yaml", *arguments)
    wait_for((project / FIRST).exists, process)
    (number,) = cluster.jobs().keys() - before.keys()
    return process, number


def test_a_study_runs_as_jobs_and_gives_the_tables_of_a_local_one(project, cluster):
    before = cluster.jobs()
    output = finish(submit(project, cluster, "small.yaml"))
    jobs = [job for number, job in cluster.jobs().items() if number not in before]
    # Datasets, tables and figures are made where snakemake was started.
    assert sorted(job.rule for job in jobs) == sorted(receipts(project, "small"))
    assert sorted(job.cores for job in jobs) == [1, 2]
    assert all(job.state == "COMPLETED" for job in jobs), output
    assert "results/small: 12 of 12 runs are done" in output
    assert len(list((project / "results/small/runs").rglob("*.nc"))) == 12
    assert len(list((project / "results/.runs").rglob("*.nc"))) == 12
    assert len(list((project / "results/small/figures").glob("*.png"))) == 2

    tables = [f"here/small/tables/{name}.csv" for name in ("inelastic", "sticky")]
    config = ["--config", "study=small.yaml", "results=here"]
    finish(start(project, os.environ, "--cores", "2", *tables, *config))
    report = compare_folders(project / "results/small/tables", project / "here/small/tables")
    assert len({table for table, *_ in report}) == 2
    assert all(grade is Grade.OK for *_, grade, _ in report), report


def test_a_dry_run_shows_the_jobs_that_will_be_submitted(project, cluster):
    before = cluster.jobs()
    output = finish(submit(project, cluster, "slow.yaml", "--dry-run"))
    # On one core, which is what a dry run claims to have, the two runs would be two jobs.
    assert "2 runs from slow/e~0.5/N~8" in output
    assert len(list((project / "results/slow/jobs").glob("[0-9a-f]*.json"))) == 1
    assert cluster.jobs() == before


def test_a_job_killed_on_its_node_is_tried_again_with_more_memory_and_time(project, cluster):
    process, number = started_and_computing(project, cluster)
    computed = first_computed(project)
    for pid in cluster.pids(number):
        with contextlib.suppress(ProcessLookupError):  # it ended with one that was killed before
            os.kill(pid, signal.SIGKILL)
    output = finish(process)
    assert output.count("FAILED  2 runs") == 1 and "  failed  2 runs" not in output, output
    killed = cluster.jobs()[number]
    again = list(cluster.jobs().values())[-1]
    assert (killed.state, again.state) == ("FAILED", "COMPLETED")
    assert [killed.rule, again.rule] == 2 * receipts(project, "slow")
    assert (again.memory_mb, again.minutes) == (2 * killed.memory_mb, 2 * killed.minutes)
    # The second attempt left alone what the first had computed.
    assert first_computed(project) == computed
    assert read_dataset(project / "results/slow/runs/slow/e~0.5/N~128.nc")["status"] == 0
    assert (project / "results/slow/figures/slow.png").exists()


def test_ctrl_c_cancels_the_jobs_and_the_same_command_goes_on(project, cluster):
    partition = ["--default-resources", "slurm_partition=long"]
    process, number = started_and_computing(project, cluster, *partition)
    computed = first_computed(project)
    os.killpg(process.pid, signal.SIGINT)
    output = finish(process, succeeds=False)
    assert "the same command goes on" in output and "Traceback" not in output, output
    assert receipts(project, "slow") == []
    cancelled = cluster.jobs()[number]
    assert (cancelled.state, cancelled.partition) == ("CANCELLED", "long")
    finish(submit(project, cluster, "slow.yaml"))
    assert first_computed(project) == computed
    assert (project / "results/slow/figures/slow.png").exists()
