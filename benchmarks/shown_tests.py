"""Tests run on a copy of the repository, each time in a fork of one process that holds the libraries.

Starting the libraries takes longer than most tests.
"""

import contextlib
import importlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mutations import Mutation

REPOSITORY = Path(__file__).parents[1]

LIBRARIES = (
    "numpy", "scipy.special", "scipy.optimize", "scipy.linalg", "scipy.fft", "scipy.integrate", "numba",
    "pyfftw", "xarray", "pandas", "netCDF4", "dask", "pydantic", "hypothesis", "pytest", "_pytest.pytester",
    "array_api_strict", "filelock", "psutil", "tqdm",
)  # fmt: skip
"""What a mutant need not import for itself: nothing of it is mutated."""

MEMORY = 8 * 2**30
"""Bytes of address space; a mutant that wants more is killed by its MemoryError."""


@dataclass(frozen=True)
class Seen:
    """What an undisturbed run of the tests showed.

    Attributes
    ----------
    seconds : dict
        Of each test.
    tests : dict
        Tests that run a line, by file and line.
    """

    seconds: dict[str, float]
    tests: dict[str, dict[int, list[str]]]


class Watch:
    """A plugin of pytest that tells coverage which test runs, and notes the processor's seconds of each."""

    def __init__(self, coverage: Any) -> None:
        self.coverage, self.seconds = coverage, dict[str, float]()

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """A test begins."""
        self.coverage.switch_context(nodeid)
        self.seconds[nodeid] = -sum(os.times()[:4])

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """A test is over."""
        self.seconds[nodeid] += sum(os.times()[:4])

    def pytest_runtest_logreport(self, report: Any) -> None:
        """A part of a test is over: setting up, the call or its end."""
        if report.outcome != "passed" and not hasattr(report, "wasxfail"):
            self.seconds[report.nodeid] = float("inf")  # skipped here, or fails unchanged


def preload() -> None:
    """Import the libraries, for all forks to come."""
    for name in LIBRARIES:
        importlib.import_module(name)


def forked(folder: Path, task: Callable[[], int], seconds: float) -> str:
    """How a task ends in a process of its own: ``passed``, ``failed``, ``time`` or ``crash``."""
    pid = os.fork()
    if pid == 0:
        os.setpgid(0, 0)
        os.chdir(folder)
        with (folder / "output").open("wb") as output:
            os.dup2(output.fileno(), 1)
            os.dup2(output.fileno(), 2)
        ours = ("", str(REPOSITORY), str(Path(__file__).parent))
        sys.path[:] = [str(folder), *(path for path in sys.path if path not in ours)]
        os.environ["PYTHONPATH"] = str(folder)
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        failed = 1
        try:
            failed = task()
        finally:
            sys.stdout.flush()
            os._exit(failed)
    end, done = time.monotonic() + 10 * seconds + 60, 0
    while not done:
        done, code = os.waitpid(pid, os.WNOHANG)
        if done:
            break
        if time.monotonic() > end:
            os.killpg(pid, signal.SIGKILL)
        time.sleep(0.02)
    status = os.waitstatus_to_exitcode(code)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)  # what the tests started
    if status in (-signal.SIGXCPU, -signal.SIGKILL):
        return "time"
    return "passed" if status == 0 else "crash" if status < 0 else "failed"


def run_tests(tests: list[str], *plugins: Any) -> int:
    """Run tests in this process, in the order given; returns pytest's status.

    Without plugins the first failure is the last test. Where a mutant gives a test other parameters, its name
    is not found, and all tests of the files are run.
    """
    import pytest

    options = ["-q", "-n0", "-p", "no:cacheprovider", "--basetemp=temporary", "--hypothesis-seed=0"]
    if not plugins:
        options.append("-x")
    status = pytest.main([*options, *tests], plugins=list(plugins))
    if status == pytest.ExitCode.USAGE_ERROR:
        files = dict.fromkeys(test.partition("::")[0] for test in tests)
        status = pytest.main([*options, *files], plugins=list(plugins))
    return int(status)


def look(folder: Path, tests: Sequence[str], kept: Path | None) -> Seen:
    """Run the tests unchanged, and see which lines each runs and how long it takes.

    What was seen is ``kept`` in a file, and taken from there where the file exists.
    """
    found = kept or folder / "seen.json"

    def task() -> int:
        import coverage

        measure = coverage.Coverage(
            config_file=False, data_file=None, source=[str(folder / "granstudy")], messages=False
        )
        watch = Watch(measure)
        measure.start()
        run_tests(list(tests), watch)
        measure.stop()
        data, lines = measure.get_data(), dict[str, dict[int, list[str]]]()
        for file in data.measured_files():
            name = str(Path(file).relative_to(folder))
            lines[name] = {
                line: sorted(set(filter(None, contexts)))
                for line, contexts in data.contexts_by_lineno(file).items()
            }
        found.write_text(json.dumps([watch.seconds, lines]))
        return 0

    if found.exists():  # then Python's bytecode is still to be made
        how = forked(folder, lambda: run_tests(["--collect-only", *tests]), 600)
    else:
        how = forked(folder, task, 7200)
    if how != "passed":
        raise SystemExit((folder / "output").read_text())
    shutil.rmtree(folder / "temporary", ignore_errors=True)
    seconds, lines = json.loads(found.read_text())
    numbered = {
        file: {int(line): tests for line, tests in one.items()} for file, one in lines.items()
    }
    return Seen(seconds, numbered)


def chosen_tests(
    mutation: Mutation, seen: Seen, above: dict[str, set[str]], seconds: float
) -> list[str]:
    """Tests to show a mutant, as many as take ``seconds``: quick ones first.

    These are tests that run the line; after them, as files share fixtures and caches, all others of their
    files. Where a line runs before the tests or in a forked process, or is compiled, they are tests in files
    that import the module, then tests that run the module, or the modules that import it.
    """
    direct = set(seen.tests.get(mutation.module, {}).get(mutation.line, ()))
    named = set[str]()
    if not direct:
        files = above.get(mutation.module, ())
        named = {
            test
            for test, taken in seen.seconds.items()
            if taken <= seconds and test.partition("::")[0] in files
        }
    modules = {mutation.module}
    while not direct and modules:
        direct = {
            test for one in modules for tests in seen.tests.get(one, {}).values() for test in tests
        }
        modules = {other for one in modules for other in above.get(one, ())}
    around = {test.partition("::")[0] for test in direct}
    beside = {test for test in seen.seconds if test.partition("::")[0] in around} - direct - named
    chosen, total = list[str](), 0.0
    for group in (named, direct - named, beside):
        for test in sorted(group, key=lambda one: (seen.seconds[one], one)):
            total += seen.seconds[test]
            if total > seconds and chosen:
                break
            chosen.append(test)
    return chosen


def importers(root: Path) -> dict[str, set[str]]:
    """Files that import a file, tests among them, by path in the repository."""
    sys.path.append(str(root / "tests"))
    architecture = importlib.import_module("architecture")
    files = architecture.modules(root / "granstudy")
    found = defaultdict[str, set[str]](set)
    for one in architecture.imports(root / "granstudy"):
        imported, importer = (
            str(files[name].relative_to(root)) for name in (one.imported, one.importer)
        )
        found[imported].add(importer)
    for test in (root / "tests").rglob("test_*.py"):
        text = test.read_text(encoding="utf-8")
        for name, file in files.items():
            if f"from {name} import" in text:
                found[str(file.relative_to(root))].add(str(test.relative_to(root)))
    return found


def copy_repository(folder: Path) -> Path:
    """The repository's files as they are now, with machine code that is there already."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=REPOSITORY, text=True, check=True, stdout=subprocess.PIPE,
    ).stdout.split("\n")  # fmt: skip
    kept = [str(path.relative_to(REPOSITORY)) for path in REPOSITORY.glob("granstudy/**/*.nbc")]
    for name in filter(None, [*listed, *kept]):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(REPOSITORY / name, folder / name)
    return folder


def outcome(
    mutation: Mutation, original: Path, scratch: Path, tests: list[str], seconds: float
) -> str:
    """Make a mutant, show it the tests, and say how it ended."""
    folder = scratch / "mutant"
    shutil.copytree(original, folder, copy_function=os.link, symlinks=True)
    try:
        path = folder / mutation.module
        source = path.read_text(encoding="utf-8")
        path.unlink()
        path.write_text(mutation.apply(source), encoding="utf-8")
        how = forked(
            folder, lambda: run_tests(tests), 3 * seconds + (60 if mutation.compiled else 15)
        )
        return "survived" if how == "passed" else f"killed: {'test' if how == 'failed' else how}"
    finally:
        shutil.rmtree(folder)
