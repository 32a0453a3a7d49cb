"""Arguments that several commands take, and how they count."""

import click

STUDY = click.argument("study", type=click.Path(exists=True, dir_okay=False), metavar="STUDY.yaml")
"""The study file."""

RESULTS = click.option(
    "--results",
    default="results",
    show_default=True,
    metavar="FOLDER",
    help="Folder of the results of all studies.",
)
"""Where results lie."""


def counted(number: int, what: str) -> str:
    """So many of something: 1 run, 2 runs."""
    return f"{number} {what}" + ("" if number == 1 else "s")
