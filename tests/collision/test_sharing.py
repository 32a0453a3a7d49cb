"""One operator in several threads and processes: everywhere the numbers that it gives alone."""

import multiprocessing
import os
import pickle
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import dask
import numpy as np
import pytest

import granstudy as gs
from granstudy.collision.fourier.threads import OneAtATime, planning

GIVEN_UP = 300
"""Seconds after which a process that hangs is given up; a process that does not takes a few."""

SOLVERS = {
    "fast": {"method": "fast"},
    "fast, single": {"method": "fast", "precision": "single"},
    "fast, dealias": {"method": "fast", "dealias": True},
    "fast, rtol": {"method": "fast", "rtol": 3e-2},
    "literal": {"method": "literal"},
    "direct": {"method": "direct"},
    "carleman": {"method": "carleman"},
    "radial": {"method": "radial"},
}


def made(name, threads=2):
    settings = SOLVERS[name]
    scene = gs.load_scene("bkw2d", restitution=1.0 if name == "carleman" else 0.5)
    sizes = {} if "rtol" in settings else {"N_rho": 6, "M_cir": 12}
    solver = gs.Solver(N=16, R=7.0, threads=threads, **sizes, **settings)
    return scene, gs.collision_operator(scene, solver)


def densities(scene, operator, count=6):
    """Densities with the scene's symmetry, each another one."""
    f = scene.density(operator.grid)
    return [f * (1.0 + 0.3 * i) + 0.01 * i * f**2 for i in range(count)]


@pytest.mark.fault("A1")
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", SOLVERS)
def test_threads_get_the_numbers_that_they_get_alone(name, threads):
    scene, Q = made(name, threads)
    states = densities(scene, Q)
    alone = [Q(f) for f in states]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(Q, states * 8))
    for q, expected in zip(together, alone * 8, strict=True):
        np.testing.assert_array_equal(q, expected)


@pytest.mark.fault("A1")
@pytest.mark.parametrize("name", SOLVERS)
def test_dask_on_threads(name):
    scene, Q = made(name)
    states = densities(scene, Q)
    asked = [dask.delayed(Q)(f) for f in states * 4]
    together = dask.compute(*asked, scheduler="threads", num_workers=4)
    for q, f in zip(together, states * 4, strict=True):
        np.testing.assert_array_equal(q, Q(f))


@pytest.mark.fault("A1")
def test_spectra_and_parts_of_an_evaluation_on_threads():
    scene, literal = made("literal")
    f_hat = np.fft.fftn(scene.density(literal.grid))
    _, tuned = made("fast, rtol")
    f = scene.density(tuned.grid)
    tasks = [
        (lambda: literal.spectrum(f_hat), literal.spectrum(f_hat)),
        (lambda: tuned.operator.loss(f), tuned.operator.loss(f)),
        (lambda: tuned.check(f), tuned.check(f)),
        (lambda: (literal.transform(), tuned.transform()), (None, None)),
    ]
    with ThreadPoolExecutor(4) as pool:
        done = [(pool.submit(task), alone) for task, alone in tasks * 20]
        for task, alone in done:
            np.testing.assert_array_equal(task.result(), alone)


def test_transforms_made_again_and_again_for_benchmarks_do_not_overflow():
    scene, literal = made("literal", threads=1)
    Q = literal(scene.density(literal.grid))
    for _ in range(150):  # each is a factor of 16² on what is there, and 256^128 overflows
        literal.transform()
    [work] = literal.workers.workspaces
    assert np.all(np.isfinite(work.density)) and np.all(np.isfinite(work.spectrum))
    np.testing.assert_array_equal(literal(scene.density(literal.grid)), Q)


def test_a_tuning_beside_evaluations_gives_one_quadrature_or_the_other():
    scene, Q = made("fast, rtol")
    f = scene.density(Q.grid)
    wide = gs.load_scene("maxwellian2d", temperature=1.5).density(Q.grid)
    before = Q(f)
    with ThreadPoolExecutor(4) as pool:
        tuning = pool.submit(Q.tune, wide)
        during = [pool.submit(Q, f) for _ in range(60)]
        plan = tuning.result()
    after = Q(f)
    assert plan is Q.plan and not np.array_equal(before, after)
    for q in during:
        assert any(np.array_equal(q.result(), one) for one in (before, after))


def test_operators_made_on_several_threads():
    def evaluated(name):
        scene, Q = made(name)
        return Q(scene.density(Q.grid))

    names = ["fast", "literal", "carleman", "fast, single"]
    alone = [evaluated(name) for name in names]
    with ThreadPoolExecutor(4) as pool:
        for q, expected in zip(pool.map(evaluated, names * 6), alone * 6, strict=True):
            np.testing.assert_array_equal(q, expected)


@pytest.mark.fault("B10")
@pytest.mark.parametrize("name", SOLVERS)
def test_pickled(name):
    scene, Q = made(name)
    f = scene.density(Q.grid)
    other = pickle.loads(pickle.dumps(Q))
    assert type(other) is type(Q) and other.grid == Q.grid and other.transforms == Q.transforms
    np.testing.assert_array_equal(other(f), Q(f))


@pytest.mark.parametrize("variant", ["full", "separate"])
def test_a_pickle_holds_the_plan_in_use(variant, monkeypatch):
    scene = gs.load_scene("bkw2d", restitution=0.5)
    Q = gs.collision_operator(scene, gs.Solver(N=16, R=7.0, rtol=3e-2, variant=variant, threads=1))
    plan = Q.tune(gs.load_scene("maxwellian2d", temperature=1.5).density(Q.grid))
    content = pickle.dumps(Q)
    monkeypatch.setattr(
        "granstudy.collision.fast.adaptive.operator.make_plan",
        lambda *arguments: pytest.fail("chosen again"),
    )
    other = pickle.loads(content)
    assert other.plan == plan
    np.testing.assert_array_equal(other(scene.density(Q.grid)), Q(scene.density(Q.grid)))


@pytest.mark.parametrize("method", ["literal", "fast"])
def test_a_pickle_holds_the_directions_of_a_file(tmp_path, monkeypatch, method):
    monkeypatch.chdir(tmp_path)
    Path("nodes.txt").write_text("1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n")
    scene = gs.load_scene("bkw3d", restitution=0.5)
    solver = gs.Solver(
        N=8, R=7.0, N_rho=3, M_sph=6, sphere_rule="nodes.txt", method=method, threads=1
    )
    Q = gs.collision_operator(scene, solver)
    content = pickle.dumps(Q)
    Path("nodes.txt").unlink()
    f = scene.density(Q.grid)
    np.testing.assert_array_equal(pickle.loads(content)(f), Q(f))


PROCESSES = """
    import multiprocessing, sys
    import numpy as np
    import granstudy as gs

    def ask(operators, f, answers):
        for Q in operators:
            answers.put(Q(f))

    if __name__ == "__main__":
        scene = gs.load_scene("bkw2d", restitution=1.0)
        sizes = dict(N_rho=6, M_cir=12)
        settings = [sizes | {"method": m} for m in ("fast", "literal", "carleman", "direct")]
        operators = [
            gs.collision_operator(scene, gs.Solver(N=16, R=7.0, threads=2, **fields))
            for fields in (*settings, {"rtol": 0.1})
        ]
        f = scene.density(operators[0].grid)
        alone = [Q(f) for Q in operators]
        context = multiprocessing.get_context(sys.argv[1])
        answers = [context.Queue() for _ in range(2)]
        workers = [context.Process(target=ask, args=(operators, f, each)) for each in answers]
        for worker in workers:
            worker.start()
        for each in answers:
            for q in alone:
                np.testing.assert_array_equal(each.get(), q)
        for worker in workers:
            worker.join()
            assert worker.exitcode == 0
        for Q, q in zip(operators, alone):
            np.testing.assert_array_equal(Q(f), q)
"""


@pytest.mark.fault("B10")
@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_processes(tmp_path, start):
    if start not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {start} on {sys.platform}")
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(PROCESSES))
    subprocess.run([sys.executable, str(script), start], check=True, timeout=GIVEN_UP)


@pytest.mark.fault("B10")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the platform cannot fork")
def test_a_fork_waits_for_plans_and_finds_locks_free(tmp_path):
    lock = OneAtATime()
    with ThreadPoolExecutor(1) as pool:
        pool.submit(lock.__enter__).result()  # another thread, which the child does not have
        pool.submit(planning.acquire).result()
        opening = pool.submit(planning.release)
        child = os.fork()
        if child == 0:
            free = lock._lock.acquire(timeout=1.0) and planning.acquire(timeout=1.0)
            os._exit(0 if free else 1)
        assert os.waitpid(child, 0)[1] == 0
        opening.result()
        pool.submit(lock.__exit__).result()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the platform cannot fork")
def test_any_thread_of_a_forked_process_may_plan():
    child = os.fork()
    if child == 0:
        with ThreadPoolExecutor(1) as pool:
            free = pool.submit(planning.acquire, timeout=10.0).result()
        os._exit(0 if free else 1)
    assert os.waitpid(child, 0)[1] == 0
