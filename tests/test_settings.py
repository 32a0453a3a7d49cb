"""Settings that are written in two places say the same."""

import re
import tomllib
from pathlib import Path

import yaml
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
LOCK = (ROOT / "requirements.lock").read_text()

BESIDE_THE_WORKFLOW = {"snakemake", "snakemake-interface-logger-plugins"}
"""What starts a workflow's jobs is no library of theirs."""


LOCKED = ("test", "notebook", "docs", "slurm")
"""Extras that the lock holds; a GPU's libraries depend on the GPU."""


def required(lines):
    return {Requirement(line).name.lower(): Requirement(line) for line in lines}


def locked():
    """Versions by name; a package has several where they differ by version of Python."""
    found = {}
    for name, version in re.findall(r"^([\w.-]+)==([^ ;]+)", LOCK, re.M):
        found.setdefault(name.lower(), []).append(version)
    return found


def test_the_lock_has_every_dependency_in_a_version_that_is_allowed():
    extras = PROJECT["optional-dependencies"]
    wanted = required(
        [*PROJECT["dependencies"], *(line for name in LOCKED for line in extras[name])]
    )
    del wanted["granstudy"]
    pins = locked()
    assert {name for name in wanted if name not in pins} == set()
    for name, requirement in wanted.items():
        assert all(requirement.specifier.contains(version) for version in pins[name]), name


def test_the_lock_has_checksums_and_names_no_place():
    entries = re.split(r"^(?=\w)", LOCK, flags=re.M)[1:]
    assert len(entries) == sum(map(len, locked().values()))
    assert all("--hash=sha256:" in entry for entry in entries)
    assert not re.search(r"://|file:|^-|@ ", LOCK, re.M)


def test_the_conda_environment_has_the_libraries_of_the_package():
    environment = yaml.safe_load((ROOT / "granstudy/workflow/envs/granstudy.yaml").read_text())
    libraries = required(environment["dependencies"])
    assert str(libraries.pop("python").specifier) == PROJECT["requires-python"]
    wanted = required([*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["notebook"]])
    assert libraries == {
        name: requirement for name, requirement in wanted.items() if name not in BESIDE_THE_WORKFLOW
    }
