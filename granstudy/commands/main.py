"""The command line: one small command a task, around `snakemake`."""

from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import click

from granstudy.commands.checking import check, plan
from granstudy.commands.citing import cite
from granstudy.commands.opening import open_
from granstudy.commands.pruning import prune
from granstudy.commands.running import run
from granstudy.commands.starting import init, new
from granstudy.commands.tuning import tune
from granstudy.commands.verifying import verify
from granstudy.commands.watching import status

Command = Callable[..., Any]


class Errors(click.Group):
    """A group whose commands say a ValueError in its own words, without a traceback."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command that was asked for."""
        try:
            return super().invoke(ctx)
        except (ValueError, FileNotFoundError) as error:
            raise click.ClickException(str(error)) from None


@click.group(cls=Errors, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(version("granstudy"), prog_name="granstudy")
def granstudy() -> None:
    """Parameter studies of granular gases.

    Snakemake does the work: `granstudy run my_study.yaml` prints and starts the `snakemake` command that
    computes a study. The other commands look at studies and their results.
    """


for command in (new, init, check, plan, run, status, open_, prune, verify, tune, cite):
    granstudy.add_command(command)
