"""The package as it is installed: wheel and source distribution, tried outside the checkout.

Libraries come from a package index, in the versions of the lock.
"""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path, PurePosixPath

import pytest

import granstudy as gs

REPOSITORY = Path(__file__).parents[1]

PACKAGES = ("granstudy", "snakemake_logger_plugin_granstudy")

STUDY = """
title: tiny
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw2d}
    solver: {R: 7.8, N: 8, N_rho: 8, M_cir: 8, method: literal} # of which nothing has to be compiled
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - e: [0.5, 0.7]
    table: {quantity: temperature}
    figure: {kind: cooling}
"""

pytestmark = pytest.mark.slow


def run(folder, *command, **variables):
    """What a command says that succeeds; nothing of the checkout is on its path."""
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        command, cwd=folder, env=environment | variables, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Folder with the source distribution, and the wheel that is made from it."""
    folder = tmp_path_factory.mktemp("dist")
    run(REPOSITORY, sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder))
    return folder


@pytest.fixture(scope="module")
def wheel(built):
    (path,) = built.glob("*.whl")
    assert path.name == f"granstudy-{gs.__version__}-py3-none-any.whl"
    return path


class Environment:
    """A virtual environment with the wheel, its libraries, and nothing else."""

    def __init__(self, folder, wheel, python):
        uv = shutil.which("uv")
        assert uv, "pip install uv"
        pins = re.findall(
            r"^[\w.-]+==[^\\\n]+", (REPOSITORY / "requirements.lock").read_text(), re.M
        )
        (folder / "pins.txt").write_text("\n".join(pins))
        self.place, self.folder = folder / "environment", folder / "empty"
        self.folder.mkdir()
        run(folder, uv, "venv", "--quiet", "--python", python, str(self.place))
        self.bin = self.place / ("Scripts" if os.name == "nt" else "bin")
        into = ["--python", str(self.bin / "python"), "--constraint", "pins.txt"]
        run(folder, uv, "pip", "install", "--quiet", *into, str(wheel))

    def run(self, program, *arguments):
        path = f"{self.bin}{os.pathsep}{os.environ['PATH']}"
        program = shutil.which(program, path=str(self.bin))
        cache = str(self.place / "cache")
        return run(self.folder, program, *arguments, PATH=path, GRANSTUDY_CACHE=cache)


def test_the_wheel_has_all_of_the_package_and_nothing_else(built, wheel):
    tracked = run(REPOSITORY, "git", "ls-files", *PACKAGES).splitlines()
    inside = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert inside == {name for name in tracked if (REPOSITORY / name).is_file()}
    assert wheel.stat().st_size < 2e6
    (source,) = built.glob("*.tar.gz")
    with tarfile.open(source) as archive:
        names = {str(PurePosixPath(*Path(name).parts[1:])) for name in archive.getnames()}
    assert {"Snakefile", "CITATION.cff", "studies/quick.yaml", "tests/test_wheel.py"} <= names
    assert not any(Path(name).parts[:1] in {("results",), (".github",)} for name in names)
    assert source.stat().st_size < 2e7


def test_a_bare_environment_computes_a_study(tmp_path, wheel):
    bare = Environment(tmp_path, wheel, sys.executable)
    where = "import granstudy as gs; print(gs.__version__, gs.__file__)"
    version, file = bare.run("python", "-c", where).split()
    assert version == gs.__version__ and Path(file).is_relative_to(bare.place)

    (bare.folder / "tiny.yaml").write_text(STUDY)
    output = bare.run("granstudy", "run", "tiny.yaml")
    assert "snakemake --snakefile" in output and "2 of 2 runs are done" in output
    assert (bare.folder / "results/tiny/figures/cooling.png").is_file()

    bare.run("granstudy", "init", "--study", "tiny.yaml")
    assert "granstudy run mine.yaml" in bare.run("granstudy", "new", "mine.yaml")
    (bare.folder / "results/tiny/tables/cooling.md").unlink()
    bare.run("snakemake", "--cores", "2")
    assert (bare.folder / "results/tiny/tables/cooling.md").is_file()


@pytest.mark.parametrize("version", ["3.11", "3.12", "3.13", "3.14"])
def test_every_python_that_is_here_computes_a_study(tmp_path, wheel, version):
    found = subprocess.run(
        [shutil.which("uv"), "python", "find", "--no-python-downloads", version],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    python = found.stdout.strip()
    if not python or f"{sys.version_info.major}.{sys.version_info.minor}" == version:
        pytest.skip("the tests' own" if python else f"no Python {version} here")
    other = Environment(tmp_path, wheel, python)
    (other.folder / "tiny.yaml").write_text(STUDY)
    assert "2 of 2 runs are done" in other.run("granstudy", "run", "tiny.yaml")
