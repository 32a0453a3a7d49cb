"""`granstudy check` and `granstudy plan`: a study before it runs."""

import click

from granstudy.analysis.tables.overview import overview
from granstudy.commands.options import RESULTS, STUDY, counted
from granstudy.workbench.open_study import open_study


@click.command()
@STUDY
@RESULTS
def check(study: str, results: str) -> None:
    """Check a study file: every run, reference, table and figure, before any work."""
    opened = open_study(study, results=results)
    found = [counted(len(opened.experiments), "experiment"), counted(len(opened.runs), "run")]
    click.echo(f"{study}: {', '.join(found)}, no mistakes")


@click.command()
@STUDY
@RESULTS
@click.option("--cores", default=2, show_default=True, help="Cores that will work.")
def plan(study: str, results: str, cores: int) -> None:
    """Say what a study will take: runs that are done and that remain, seconds and memory.

    `snakemake plan` writes a line for each run.
    """
    opened = open_study(study, results=results)
    click.echo(overview(opened.layout, cores))
    click.echo(f"next: granstudy run {study}")
