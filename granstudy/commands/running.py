"""`granstudy run`: the `snakemake` command of a study, shown and started."""

import shlex
import subprocess
import sys
from pathlib import Path

import click

from granstudy.commands.options import RESULTS, STUDY


@click.command(context_settings={"ignore_unknown_options": True})
@STUDY
@RESULTS
@click.option("--cores", default=2, show_default=True, help="Cores that work.")
@click.argument("snakemake_arguments", nargs=-1, type=click.UNPROCESSED)
def run(study: str, results: str, cores: int, snakemake_arguments: tuple[str, ...]) -> None:
    """Compute a study: print the `snakemake` command, and start it.

    Further arguments go to snakemake, as in `granstudy run my_study.yaml -n`.
    """
    if not Path("Snakefile").is_file():
        raise ValueError(
            f"{Path.cwd()}: has no Snakefile; go to the folder of granstudy's checkout, which has it"
        )
    command = ["snakemake", "--cores", str(cores), *snakemake_arguments]
    command += ["--config", f"study={study}", f"results={results}"]
    click.echo(shlex.join(command))
    sys.exit(subprocess.run([sys.executable, "-m", *command], check=False).returncode)
