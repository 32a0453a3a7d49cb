"""`granstudy open`: a study in an IPython session."""

import click
import IPython

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
    lines = "['import granstudy as gs', 'import xarray as xr']"
    IPython.start_ipython(
        argv=["--no-banner", f"--InteractiveShellApp.exec_lines={lines}"],
        user_ns={"study": opened},
    )
