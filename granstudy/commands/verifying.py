"""`granstudy verify`: datasets computed anew."""

import sys

import click

from granstudy.support.errors import DamagedFileError
from granstudy.workbench.verifying import verify_dataset


@click.command()
@click.argument("files", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False))
@click.option("--run-code", is_flag=True, help="Run the user's code that a file holds.")
@click.option(
    "--tolerance",
    default=1e-9,
    show_default=True,
    help="Largest difference that counts as the same, over a variable's largest value.",
)
def verify(files: tuple[str, ...], run_code: bool, tolerance: float) -> None:
    """Compute runs anew from what their files say, and compare.

    Exits with 1 if a file is damaged, cannot be computed anew, or differs by more than the tolerance.
    """
    bad = 0
    for file in files:
        try:
            verdict = verify_dataset(file, run_code)
        except DamagedFileError as error:
            click.echo(f"{file}: damaged: {error}")
            bad += 1
            continue
        except ValueError as error:
            click.echo(f"{file}: not verified: {error}")
            bad += 1
            continue
        code = "" if verdict.same_code else ", the code changed since"
        if not verdict.differences:
            click.echo(f"{file}: the same bit for bit{code}")
            continue
        worst = max(verdict.differences, key=verdict.differences.__getitem__)
        what = f"{worst} differs by {verdict.largest:.1e}{code}"
        same = verdict.largest <= tolerance
        click.echo(f"{file}: {'the same' if same else 'NOT the same'}: {what}")
        bad += not same
    sys.exit(1 if bad else 0)
