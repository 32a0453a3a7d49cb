"""Arguments that several commands take."""

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
