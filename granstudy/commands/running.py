"""`granstudy run`: the `snakemake` command of a study, shown and started."""

import shlex
import subprocess
import sys
from pathlib import Path

import click

from granstudy.commands.options import RESULTS, STUDY
from granstudy.commands.starting import WORKFLOW

CONFIG = ("--config", "-C")
"""Snakemake's option for what a workflow is told."""

SNAKEFILES = ("Snakefile", "snakefile", "workflow/Snakefile", "workflow/snakefile")
"""Files that Snakemake takes by itself."""


@click.command(context_settings={"ignore_unknown_options": True})
@STUDY
@RESULTS
@click.option("--cores", default=2, show_default=True, help="Cores that work.")
@click.argument("snakemake_arguments", nargs=-1, type=click.UNPROCESSED)
def run(study: str, results: str, cores: int, snakemake_arguments: tuple[str, ...]) -> None:
    """Compute a study: print the `snakemake` command, and start it.

    A folder without a Snakefile takes the workflow that comes with the package. Further
    arguments go to snakemake, as in `granstudy run my_study.yaml -n`.
    """
    own, arguments = [f"study={study}", f"results={results}"], list(snakemake_arguments)
    given = [place for place, word in enumerate(arguments) if word in CONFIG]
    if given:  # Snakemake takes the last of several
        arguments[given[-1] + 1 : given[-1] + 1] = own
    else:
        arguments += [CONFIG[0], *own]
    command = ["snakemake", *_snakefile(), "--cores", str(cores), *arguments]
    click.echo(shlex.join(command))
    sys.exit(_status(subprocess.Popen([sys.executable, "-m", *command])))


def _snakefile() -> list[str]:
    """What tells Snakemake where the workflow is, in a folder that has none."""
    if any(Path(name).is_file() for name in SNAKEFILES):
        return []
    return ["--snakefile", str(WORKFLOW / "Snakefile")]


def _status(process: "subprocess.Popen[bytes]") -> int:
    """How the process ended. ^C reaches it too, and it ends by itself."""
    while True:
        try:
            return process.wait()
        except KeyboardInterrupt:
            continue
