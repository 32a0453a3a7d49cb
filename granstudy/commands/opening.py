"""`granstudy open`: a study in an IPython session."""

import click
import IPython
import xarray as xr

import granstudy as gs
from granstudy.commands.options import RESULTS, STUDY
from granstudy.workbench.open_study import open_study


@click.command("open")
@STUDY
@RESULTS
def open_(study: str, results: str) -> None:
    """Open a study in IPython, as `study`, with `gs` and `xr`."""
    opened = open_study(study, results=results)
    name = opened.experiments[0]
    banner = f"{opened}\n\nstudy.runs   study.dataset({name!r})   study.table({name!r})"
    click.echo(banner)
    IPython.start_ipython(argv=["--no-banner"], user_ns={"study": opened, "gs": gs, "xr": xr})
