"""^C and its kin at several moments, on a real terminal: all ends at once, and the same command goes on."""

import pytest
from tiny_workflow import Terminal, Tiny, processes, send

INTERRUPTS = ["terminal", "alone", "group"]


@pytest.fixture
def tiny(tmp_path):
    return Tiny(tmp_path)


def goes_on(tiny, computed):
    """The same command, without seconds to wait, does what was not done, and computes no run twice."""
    status, output = tiny.run()
    assert status == 0, output
    assert "Exception" not in output and "Traceback" not in output
    assert tiny.table == "whole"
    assert tiny.computed[: len(computed)] == computed
    assert sorted(tiny.computed) == ["a0", "a1", "a2", "b0", "b1", "b2"]


def ends_at_once(terminal, tiny):
    """The workflow ends with lines that a person reads, and leaves no process behind."""
    mark = len(terminal.text)
    status, output = terminal.end()
    assert status != 0
    assert processes(tiny.folder) == []
    said = output[mark:]
    assert "Traceback" not in said and "Error" not in said, said
    assert "the same command goes on" in said
    return said


@pytest.mark.fault("B7")
@pytest.mark.slow
@pytest.mark.parametrize("kind", INTERRUPTS)
def test_amid_a_job(tiny, kind):
    terminal = Terminal(tiny, seconds=3)
    terminal.wait(lambda: len(tiny.computed) >= 2)
    send(kind, terminal)
    said = ends_at_once(terminal, tiny)
    computed = tiny.computed
    assert 2 <= len(computed) < 6
    assert f"stopped: {len(computed)} of 6 runs are done" in said
    logs = [path.read_text() for path in (tiny.folder / "results/tiny/logs").iterdir()]
    assert sum("stopped after" in log for log in logs) == 2
    goes_on(tiny, computed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", INTERRUPTS)
def test_while_the_workflow_starts(tiny, kind):
    terminal = Terminal(tiny, seconds=3)
    terminal.wait(lambda: "Using workflow specific profile" in terminal.text)
    terminal.wait((tiny.folder / ".snakemake/granstudy.alive").exists)
    send(kind, terminal)
    ends_at_once(terminal, tiny)
    goes_on(tiny, [])


@pytest.mark.slow
@pytest.mark.parametrize("kind", INTERRUPTS)
def test_while_a_job_starts(tiny, kind):
    terminal = Terminal(tiny, seconds=3)
    terminal.wait(
        lambda: any(".snakemake/scripts" in command for _, command in processes(tiny.folder))
    )
    send(kind, terminal)
    ends_at_once(terminal, tiny)
    goes_on(tiny, tiny.computed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", INTERRUPTS)
def test_while_a_table_is_made(tiny, kind):
    terminal = Terminal(tiny, seconds=0.1, table=600)
    terminal.wait(lambda: tiny.table == "half")
    send(kind, terminal)
    ends_at_once(terminal, tiny)
    assert tiny.table is None, "Snakemake removes what is half-written"
    goes_on(tiny, tiny.computed)


@pytest.mark.slow
def test_a_terminated_workflow_finishes_its_jobs(tiny):
    terminal = Terminal(tiny, seconds=1)
    terminal.wait(lambda: len(tiny.computed) >= 2)
    send("terminate", terminal)
    status, output = terminal.end()
    assert status != 0 and len(tiny.computed) == 6 and tiny.table is None, output
    goes_on(tiny, tiny.computed)


@pytest.mark.fault("B7")
@pytest.mark.slow
def test_a_killed_workflow_needs_no_unlocking(tiny):
    terminal = Terminal(tiny, seconds=0.1, table=600)
    terminal.wait(lambda: tiny.table == "half")
    send("kill", terminal)
    terminal.end()
    assert tiny.locked
    goes_on(tiny, tiny.computed)


@pytest.mark.slow
def test_a_living_workflow_keeps_its_lock(tiny):
    terminal = Terminal(tiny, seconds=0.1, table=600)
    terminal.wait(lambda: tiny.table == "half")
    status, output = tiny.run()
    assert status != 0 and "LockException" in output
    terminal.control_c()
    ends_at_once(terminal, tiny)


@pytest.mark.slow
@pytest.mark.fault("B13")
def test_one_bad_table_stops_no_other_and_says_why(tiny):
    status, output = tiny.run(bad=1)
    assert status != 0 and tiny.table == "whole"
    assert output.count("ValueError: no such quantity: temprature") == 1
    assert "FAILED  table bad\n  log results/tiny/logs/table_bad.log:" in output
    assert "results/tiny: 6 of 6 runs are done: trusted 6" in output
    assert "  made    table good\n  failed  table bad\n" in output
    assert "Reason" not in output and "output:" not in output
