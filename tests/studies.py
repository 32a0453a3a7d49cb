"""Studies of the tests: loaded from text and computed into files; and a copy of the package to edit."""

import shutil
from pathlib import Path

from granstudy.model.choice import Choice
from granstudy.model.solver import SizedSolver, Solver
from granstudy.runs.execute import obtain
from granstudy.runs.run_key import run_fingerprint, run_key
from granstudy.runs.store import Store, link
from granstudy.study.study import load_study
from granstudy.support import fingerprint


def load_text(folder, text, name="test"):
    """The study of that name whose file, in a folder, has this text."""
    path = Path(folder) / f"{name}.yaml"
    path.write_text(text)
    return load_study(path)


def replaced(text, old, new):
    """A study's text with one thing in it changed, which must be there."""
    assert old in text
    return text.replace(old, new, 1) if old else text


def computed(runs, folder):
    """Compute an experiment's runs, given by path, as a job does; their files in the same order."""
    store = Store(Path(folder).with_name(f"{Path(folder).name}-store"))
    files = [Path(folder) / f"{run.path}.nc" for run in runs.values()]
    for run, file in zip(runs.values(), files, strict=True):
        key = run_key(run.computation)
        obtain(run.computation, key, store)
        link(store.path(key), file)
    return list(map(str, files))


def code(kind, method="fast", **fields):
    """Fingerprint of the code of runs by a solver; N and R count as open where they are None."""
    asked = Solver(**{"N": 8, "R": 7.0, "method": method} | fields)
    chosen = "radial" if asked.traits.chooses else method
    solver = SizedSolver(**{"N": 8, "R": 7.0} | fields | {"N": 8, "R": 7.0, "method": chosen})
    return run_fingerprint(kind, Choice(asked, solver, ""))


class Package:
    """A copy of the package that fingerprints are taken of while it is the one in use."""

    def __init__(self, folder):
        self.path = folder / "granstudy"
        ignored = shutil.ignore_patterns("__pycache__", "*.nb*")
        shutil.copytree(fingerprint.PACKAGE, self.path, ignore=ignored)

    def edit(self, file, old, new):
        """Change the first occurrence of some text in a file."""
        path = self.path / file
        path.write_text(replaced(path.read_text(), old, new))
        self.forget()

    def move(self, folder):
        """Lie somewhere else from now on."""
        shutil.copytree(self.path, folder / "granstudy")
        self.path = fingerprint.PACKAGE = folder / "granstudy"
        self.forget()

    @staticmethod
    def forget():
        """Read every file anew."""
        for reads in (fingerprint._code, fingerprint._fingerprint):
            reads.cache_clear()
