"""`granstudy new` and `granstudy init`: a study file, and a folder for `snakemake`, to begin with."""

import json
from importlib.resources import files
from pathlib import Path

import click

from granstudy.support.errors import unknown_name
from granstudy.support.files import write_text

TEMPLATES = {
    "cooling": "a gas that cools, swept over restitution and temperature",
    "own_gas": "a density and a law of restitution of one's own, from my_gas.py beside the study",
    "states": "cooling and heated states, solved for directly",
}
"""Templates by name, and what each is."""

WORKFLOW = Path(__file__).parents[1] / "workflow"
"""The workflow that comes with the package."""

PROFILES = ("default", "slurm")
"""Profiles of Snakemake that `granstudy init` writes."""


@click.command()
@click.argument("file", type=click.Path(dir_okay=False), metavar="STUDY.yaml")
@click.option(
    "--template",
    default="cooling",
    show_default=True,
    metavar="NAME",
    help="; ".join(f"{name}: {text}" for name, text in TEMPLATES.items()) + ".",
)
def new(file: str, template: str) -> None:
    """Write a study file with comments, to begin with."""
    if template not in TEMPLATES:
        raise unknown_name("template", template, list(TEMPLATES))
    path = Path(file)
    made = {path: f"{template}.yaml"}
    if template == "own_gas":
        made[path.parent / "my_gas.py"] = "my_gas.py"
    texts = {target: _template(source) for target, source in made.items()}
    _write({target: text.replace("my_study.yaml", str(path)) for target, text in texts.items()})
    click.echo(f"next: granstudy plan {path}, then granstudy run {path}")


@click.command()
@click.argument("folder", default=".", type=click.Path(file_okay=False), metavar="[FOLDER]")
@click.option(
    "--study",
    default="my_study.yaml",
    show_default=True,
    metavar="STUDY.yaml",
    help="The study that `snakemake --cores 2` computes there.",
)
def init(folder: str, study: str) -> None:
    """Make a folder in which `snakemake` itself computes studies: a Snakefile, and profiles.

    `granstudy run` needs neither. They are for those who call Snakemake: by other targets, on a cluster, with
    rules of their own. The rules of studies stay in the package, which the Snakefile includes.
    """
    path = Path(folder)
    made = {
        path / "Snakefile": _template("Snakefile").replace('"my_study.yaml"', json.dumps(study))
    }
    for name in PROFILES:
        source = WORKFLOW / "profiles" / name / "config.yaml"
        made[path / "profiles" / name / "config.yaml"] = source.read_text(encoding="utf-8")
    _write(made)
    there = "" if folder == "." else f"in {folder}: "
    click.echo(f"next: {there}granstudy new {study}, then snakemake --cores 2")


def _template(name: str) -> str:
    """Text of a template."""
    return files(__package__).joinpath("templates", name).read_text(encoding="utf-8")


def _write(texts: dict[Path, str]) -> None:
    """Write files, none of them over another one."""
    for target in texts:
        if target.exists():
            raise ValueError(f"{target}: is there already; take another name")
    for target, text in texts.items():
        write_text(target, text)
        click.echo(f"wrote {target}")
