"""Execute an analysis notebook on a study's datasets."""

from pathlib import Path

import nbformat
from nbclient import NotebookClient

from granstudy.support.files import write_whole

LONGEST_CELL_SECONDS = 600


def execute_notebook(source: str | Path, target: str | Path, results: str) -> None:
    """Run ``source`` in the current directory and write it, with its outputs, to ``target``.

    Parameters
    ----------
    results : str
        Folder of the study's results, which the cell tagged ``parameters`` sets.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails; nothing is written then.
    """
    notebook = nbformat.read(source, as_version=4)
    (parameters,) = (c for c in notebook.cells if "parameters" in c.metadata.get("tags", ()))
    parameters.source = f"results = {results!r}"
    NotebookClient(notebook, timeout=LONGEST_CELL_SECONDS, kernel_name="python3").execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # times of execution differ from run to run
    write_whole(Path(target), lambda partial: nbformat.write(notebook, partial))
