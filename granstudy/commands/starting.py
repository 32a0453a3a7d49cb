"""`granstudy new`: a study file to begin with."""

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
    for target in made:
        if target.exists():
            raise ValueError(f"{target}: is there already; take another name")
    for target, source in made.items():
        text = files(__package__).joinpath("templates", source).read_text(encoding="utf-8")
        write_text(target, text.replace("my_study.yaml", str(path)))
        click.echo(f"wrote {target}")
    click.echo(f"next: granstudy plan {path}, then granstudy run {path}")
