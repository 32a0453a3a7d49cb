"""What a computation tells of its progress: by functions, by bars in terminals and in notebooks."""

import math
import sys
from itertools import pairwise

import nbclient
import nbformat
import numpy as np
import pytest

import granstudy as gs
from granstudy.support import progress as module
from granstudy.support.progress import watched

SCENE = gs.load_scene("maxwellian3d", restitution=0.8, diffusion=0.0)
RADIAL = gs.Solver(N=12, R=8.0, method="radial")


class Calls(list):
    def __call__(self, done, total, time):
        self.append((done, total, time))


def test_a_run_of_fixed_steps_calls_once_an_output():
    calls = Calls()
    ds = gs.simulate(SCENE, RADIAL, t_final=0.5, dt=0.1, progress=calls)
    assert [done for done, _, _ in calls] == [0, 1, 2, 3, 4, 5]
    assert {total for _, total, _ in calls} == {5}
    np.testing.assert_allclose([time for _, _, time in calls], ds["time"])


def test_steps_between_outputs_are_told_too_when_time_has_passed(monkeypatch):
    ticks = iter(np.arange(0.0, 1e6))
    monkeypatch.setattr(module.clock, "monotonic", lambda: float(next(ticks)))
    calls = Calls()
    gs.simulate(SCENE, RADIAL, t_final=2.0, time_rtol=1e-9, times=[1.0], progress=calls)
    assert [done for done, _, _ in calls] == sorted(done for done, _, _ in calls)
    assert calls[0] == (0, 2, 0.0) and calls[-1] == (2, 2, 2.0)
    between = [time for done, _, time in calls if done == 0]
    assert len(between) > 3 and all(a < b for a, b in pairwise(between))


def test_a_function_is_not_called_again_at_once(monkeypatch):
    now = 0.0
    monkeypatch.setattr(module.clock, "monotonic", lambda: now)
    calls = Calls()
    with watched(calls, 2) as report:
        for _ in range(25):
            report(0, now)
            now += 0.01
        report(1, now)
        report(1, now)
        report(2, now)
    assert [done for done, _, _ in calls] == [0, 0, 0, 1, 2]


def test_particles_count_all_batches():
    calls = Calls()
    solver = gs.Solver(N=8, R=7.0, method="dsmc", particles=4000, batches=4)
    gs.simulate(SCENE, solver, t_final=0.4, dt=0.1, progress=calls)
    done, total, time = calls[-1]
    assert (done, total) == (20, 20) and time == pytest.approx(0.4)
    assert all(a[0] <= b[0] and a[2] <= b[2] for a, b in pairwise(calls))


def test_a_state_tells_its_iterations():
    calls = Calls()
    ds = gs.cooling_state(SCENE, RADIAL, progress=calls)
    assert [done for done, _, _ in calls] == list(range(ds.sizes["iteration"]))
    assert all(total == 20 and math.isnan(time) for _, total, time in calls)


@pytest.mark.parametrize(
    "solver", [RADIAL, gs.Solver(N=8, R=7.0, method="dsmc", particles=4000, batches=4)]
)
def test_an_error_of_the_function_ends_the_run(solver):
    def fail(done, total, time):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        gs.simulate(SCENE, solver, t_final=0.4, dt=0.1, progress=fail)


def test_progress_must_be_known():
    with pytest.raises(
        ValueError, match="progress='yes': must be True, False, None, or a function"
    ):
        gs.simulate(SCENE, RADIAL, t_final=0.1, dt=0.1, progress="yes")


@pytest.mark.parametrize(("terminal", "shown"), [(True, True), (False, False)])
def test_a_bar_shows_in_a_terminal_by_default(monkeypatch, capsys, terminal, shown):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    gs.simulate(SCENE, RADIAL, t_final=0.2, dt=0.1)
    assert ("2/2" in capsys.readouterr().err) == shown
    gs.simulate(SCENE, RADIAL, t_final=0.2, dt=0.1, progress=not shown)
    assert ("2/2" in capsys.readouterr().err) != shown


def test_a_bar_shows_in_a_notebook_without_a_warning():
    code = """import granstudy as gs
gs.simulate(gs.load_scene("maxwellian3d"), gs.Solver(N=24, R=8.0, method="radial"), t_final=0.2, dt=0.1);"""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    nbclient.NotebookClient(notebook, kernel_name="python3").execute()
    shown = "".join(str(output) for output in notebook.cells[0].outputs)
    assert "2/2" in shown
    assert "Warning" not in shown and "ipywidgets" not in shown
