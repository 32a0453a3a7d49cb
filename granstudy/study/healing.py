"""Files of an experiment's runs are those runs, whole; what is not is removed, to be computed anew."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from granstudy.datasets.netcdf import read_dataset, read_head
from granstudy.runs.store import link
from granstudy.study.layout import Layout
from granstudy.support.errors import DamagedFileError
from granstudy.support.files import read_json


@contextmanager
def healed(layout: Layout, experiment: str) -> Iterator[None]:
    """Read files of an experiment that is complete, each the run of its name.

    Before, the head of every file is verified, and its run key. Where the body finds a damaged file, all
    files are verified as a whole. A file that is another's or damaged is taken anew from the store. A run
    that is damaged there too is removed.

    Raises
    ------
    ValueError
        If runs were removed: they are missing now, and whoever computes the study computes them anew.
    """
    _check(layout, experiment, whole=False)
    try:
        yield
    except DamagedFileError:
        _check(layout, experiment, whole=True)
        raise


def _check(layout: Layout, experiment: str, whole: bool) -> None:
    lost = []
    for path, key in read_json(Path(layout.complete(experiment))).items():
        file = Path(layout.run_file(experiment, path))
        if _holds(file, key, whole):
            continue
        file.unlink(missing_ok=True)
        kept = layout.store.path(key)
        if _holds(kept, key, whole):
            link(kept, file)
        else:
            layout.store.remove(key)
            lost.append(path)
    if lost:
        raise ValueError(
            f"{experiment}: {len(lost)} runs were damaged, or files of other runs, and are removed "
            f"({', '.join(lost[:5])}{', ...' if len(lost) > 5 else ''}); the same command computes them anew"
        )


def _holds(file: Path, key: str, whole: bool) -> bool:
    """Whether a file is there, not damaged, and the run of that key."""
    try:
        attrs = read_dataset(file).attrs if whole else read_head(file).attrs
    except (OSError, ValueError):
        return False
    return bool(attrs.get("run_key") == key)
