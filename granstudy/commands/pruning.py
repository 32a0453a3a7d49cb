"""`granstudy prune`: runs that no study has any more."""

import click

from granstudy.commands.options import RESULTS
from granstudy.workbench.pruning import remove, unused


@click.command()
@RESULTS
@click.option("--yes", is_flag=True, help="Remove them; without it they are only listed.")
@click.option(
    "--give-up",
    multiple=True,
    metavar="NAME",
    help="A study or sweep that is no longer wanted, as listed: 'study old', 'sweep unnamed'.",
)
def prune(results: str, yes: bool, give_up: tuple[str, ...]) -> None:
    """List the runs in the store that no study and no sweep has; with --yes, remove them."""
    found = unused(results, give_up)
    for name, count in found.kept.items():
        click.echo(f"{name}: {count} runs, kept")
    size = found.bytes / 1e6
    if not found.keys:
        click.echo("no run is unused")
    elif yes:
        remove(results, found.keys)
        click.echo(f"removed {len(found.keys)} runs, {size:.1f} MB")
    else:
        click.echo(f"{len(found.keys)} runs, {size:.1f} MB, are no one's; --yes removes them")
