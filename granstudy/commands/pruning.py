"""`granstudy prune`: runs that no study has any more."""

import click

from granstudy.commands.options import RESULTS, counted
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
    """List the runs in the store that no study and no sweep has; with --yes, remove them.

    A study that was renamed or deleted keeps its runs until its name is given up.
    """
    found = unused(results, give_up)
    for name, count in found.kept.items():
        click.echo(f"{name}: {counted(count, 'run')}, kept")
    size = found.bytes / 1e6
    if yes:
        remove(results, found.keys, give_up)
        click.echo(f"removed {counted(len(found.keys), 'run')}, {size:.1f} MB")
    elif not found.keys:
        click.echo("no run is unused")
    else:
        click.echo(
            f"no one has {counted(len(found.keys), 'run')}, {size:.1f} MB; --yes removes them"
        )
