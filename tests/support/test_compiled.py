"""Machine code on disk: as fresh as all that it was compiled from, the same bits from it as without it."""

import importlib
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

import granstudy

HELPER = """
from granstudy.support.compiled import compiled
FACTOR = 2.0

@compiled(forceinline=True)
def scaled(x):
    return FACTOR * x
"""
KERNEL = """
from helper import scaled
from granstudy.support.compiled import compiled, source_hash

@compiled()
def tripled(x):
    return 3.0 * scaled(x)
"""
PACKAGE = Path(granstudy.__file__).parent
ASK = "import kernel; print(kernel.tripled({}), *kernel.tripled._cache_hits.values())"


def run(script, folder, **variables):
    """What a Python script prints in a process of its own, which imports from ``folder`` first."""
    env = os.environ | {"PYTHONPATH": str(folder)} | variables
    command = [sys.executable, "-c", script]
    ran = subprocess.run(command, env=env, cwd=folder, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.strip() + ran.stderr


@pytest.fixture
def sources(tmp_path, monkeypatch):
    """A compiled function that calls one of another file."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    # The cellar alone: importing all of granstudy takes longer than everything else here.
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(PACKAGE / "support", tmp_path / "granstudy" / "support", ignore=ignored)
    (tmp_path / "granstudy" / "__init__.py").write_text("")
    (tmp_path / "helper.py").write_text(HELPER)
    (tmp_path / "kernel.py").write_text(KERNEL)
    return tmp_path


def kept(folder):
    return sorted(path.name for path in (folder / "__pycache__").glob("kernel.tripled*.nbc"))


def edit(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def test_a_second_process_loads_what_the_first_compiled(sources):
    assert [run(ASK.format("1.0"), sources) for _ in range(2)] == ["6.0", "6.0 1"]


@pytest.mark.fault("A7")
@pytest.mark.parametrize(
    ("file", "old", "new", "answer"),
    [
        ("helper.py", "FACTOR * x", "FACTOR + x", "9.0"),
        ("helper.py", "FACTOR = 2.0", "FACTOR = 5.0", "15.0"),
        ("kernel.py", "3.0", "4.0", "8.0"),
    ],
)
def test_an_edit_of_what_is_inlined_is_seen(sources, file, old, new, answer):
    run(ASK.format("1.0"), sources)
    before = kept(sources)
    edit(sources / file, old, new)
    assert run(ASK.format("1.0"), sources) == answer
    assert len(kept(sources)) == 1 and kept(sources) != before


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("FACTOR = 2.0", "# of the collision\nFACTOR = 2.0"),
        ("def scaled(x):\n", 'def scaled(x):\n    """Scaled."""\n'),
    ],
)
def test_comments_docstrings_and_lines_leave_it(sources, old, new):
    run(ASK.format("1.0"), sources)
    edit(sources / "helper.py", old, new)
    assert run(ASK.format("1.0"), sources) == "6.0 1"


def test_options_count(sources):
    script = "import kernel; print(kernel.source_hash(kernel.tripled))"
    before = run(script, sources)
    edit(sources / "helper.py", "forceinline=True", 'forceinline=True, fastmath={"nsz", "arcp"}')
    after = [run(script, sources, PYTHONHASHSEED=seed) for seed in "12"]
    assert after[0] != before and after[0] == after[1]


def test_damage_is_noticed(sources):
    run(ASK.format("1.0"), sources)
    path = sources / "__pycache__" / kept(sources)[0]
    whole = path.read_bytes()
    for damaged in (b"", whole[:-1], whole[:100] + bytes([whole[100] ^ 1]) + whole[101:]):
        path.write_bytes(damaged)
        assert [run(ASK.format("1.0"), sources) for _ in range(2)] == ["6.0", "6.0 1"]


def test_code_of_another_signature_under_the_name_is_refused(sources):
    run(ASK.format("1.0"), sources)
    of_floats = kept(sources)
    run(ASK.format("1"), sources)
    (of_integers,) = set(kept(sources)) - set(of_floats)
    folder = sources / "__pycache__"
    shutil.copy(folder / of_integers, folder / of_floats[0])
    assert run(ASK.format("1.0"), sources) == "6.0"


def unwritable(folder):
    """Variables of a process for which neither source nor home nor cache has a folder to write to."""
    (folder / "__pycache__").write_text("a file where a folder is looked for")
    return {"HOME": str(folder / "helper.py"), "PYTHONDONTWRITEBYTECODE": "1"}


@pytest.mark.fault("B12")
def test_without_a_folder_there_is_one_warning_and_the_same_number(sources, monkeypatch):
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    said = run(ASK.format("1.0"), sources, **unwritable(sources))
    assert said.startswith("6.0")
    assert said.count("cannot keep machine code") == 1
    assert "Set NUMBA_CACHE_DIR" in said


def test_a_folder_that_fills_up_is_said_too(sources):
    script = (
        "import granstudy.support.compiled as c\n"
        "def full(path, write):\n    raise OSError(28, 'No space left on device')\n"
        "c.write_whole = full\n"
    )
    said = run(script + ASK.format("1.0"), sources)
    assert said.startswith("6.0") and said.count("No space left on device") == 1


def test_compiled_functions_called_by_others_are_inlined():
    """Otherwise a process calls the copy that it loaded first (`granstudy.support.compiled.compiled`)."""
    for path in PACKAGE.rglob("*.py"):
        if "import compiled" in path.read_text(encoding="utf-8"):
            module = path.relative_to(PACKAGE.parent).with_suffix("")
            importlib.import_module(".".join(module.parts))
    loops = {
        function
        for name, module in list(sys.modules.items())
        if name.startswith("granstudy.")
        for function in vars(module).values()
        if isinstance(function, Dispatcher)
    }
    called = {
        callee
        for function in loops
        for name in function.py_func.__code__.co_names
        if isinstance(callee := function.py_func.__globals__.get(name), Dispatcher)
    }
    assert len(loops) > len(called) > 15
    assert [one for one in called if not one.targetoptions.get("forceinline")] == []


@pytest.mark.fault("A7")
@pytest.mark.slow
def test_an_edit_of_the_transforms_alone_reaches_the_operators(tmp_path):
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(PACKAGE, tmp_path / "granstudy", ignore=ignored)
    script = """
import granstudy as gs
scene = gs.load_scene("bkw2d")
Q = gs.collision_operator(scene, gs.Solver(N=8, R=7.0, M_cir=4, method="carleman", threads=1))
print(gs.__file__, repr(float(abs(Q(scene.density(Q.grid))).max())))
"""
    folder = {"NUMBA_CACHE_DIR": str(tmp_path / "numba")}
    before = [run(script, tmp_path, **folder) for _ in range(2)]
    assert before[0] == before[1] and str(tmp_path) in before[0]
    edit(
        tmp_path / "granstudy" / "collision" / "fourier" / "fftw.py",
        "    plans[MADE] += 1\n",
        "    plans[MADE] += 1\n    if direction == BACKWARD:\n        return\n",
    )
    after = run(script, tmp_path, **folder)
    assert after != before[0]
    assert after == run(script, tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "fresh"))


@pytest.mark.slow
def test_a_process_that_compiles_gives_the_bits_of_one_that_loads(tmp_path):
    script = """
import hashlib
import granstudy as gs
scene = gs.load_scene("three_gaussians3d", restitution=0.5)
bits = {}
for precision in PRECISIONS:
    solver = gs.Solver(N=8, R=7.0, N_rho=4, M_sph=6, threads=1, precision=precision)
    Q = gs.collision_operator(scene, solver)
    bits[precision] = hashlib.sha256(Q(scene.density(Q.grid)).tobytes()).hexdigest()
print(sorted(bits.items()))
"""

    def bits(folder, precisions):
        folder = {"NUMBA_CACHE_DIR": str(tmp_path / folder)}
        return run(script.replace("PRECISIONS", repr(precisions)), PACKAGE.parent, **folder)

    compiled = bits("a", ["single", "double"])
    assert bits("a", ["double", "single"]) == compiled
    # Half of the code is loaded, the other half compiled.
    bits("b", ["double"])
    assert bits("b", ["single", "double"]) == compiled


FORK = """
    import os, threading, time
    from numba.core.compiler_lock import global_compiler_lock
    from granstudy.support.compiled import compiled

    @compiled()
    def twice(x):
        return 2 * x

    held, forking = threading.Event(), threading.Event()

    def compile_for_a_while():
        with global_compiler_lock:
            held.set()
            forking.wait()
            time.sleep(0.5)

    threading.Thread(target=compile_for_a_while).start()
    held.wait()
    forking.set()
    child = os.fork()
    if child == 0:
        os._exit(0 if twice(1) == 2 else 1)
    print(os.waitpid(child, 0)[1], twice(2))
"""


@pytest.mark.fault("B10")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the platform cannot fork")
def test_a_process_forked_while_another_thread_compiles_can_compile(tmp_path):
    script = tmp_path / "forking.py"
    script.write_text(textwrap.dedent(FORK))
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.stdout.split() == ["0", "4"], done.stderr
