"""`granstudy cite`: what to cite."""

import click

from granstudy.analysis.report.citation import citations


@click.command()
def cite() -> None:
    """Print what to cite, as BibTeX: the method's paper, and this software in its version."""
    for entry in citations():
        click.echo(entry)
