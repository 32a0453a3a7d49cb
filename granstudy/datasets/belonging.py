"""Which files are the runs that one asks for: those in a folder that its study has now.

A study keeps a list of its runs in ``results/<study>/runs/study.json``:
``{"study": name, "runs": {"<experiment>/<path>": run key, ...}}``. Without the list, all files count.
"""

import glob
import json
import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

LIST = "study.json"
"""Name of the list of a study's runs, in the folder of its runs."""

NAMED = 5
"""Files that a warning names."""

Where = str | Path | Iterable[str | Path]
"""Where runs lie: a folder, a glob pattern, or the files themselves."""


@dataclass(frozen=True)
class Belonging:
    """Files of runs, and what does not belong to them.

    Attributes
    ----------
    files : list of str
    keys : mapping of str
        The run key that a file must have, for files of a study that keeps a list.
    strangers : list of str
        Files that the study does not have now.
    missing : list of str
        Files that the study has, and that are not there.
    """

    files: list[str]
    keys: Mapping[str, str] = field(default_factory=dict)
    strangers: Sequence[str] = ()
    missing: Sequence[str] = ()

    def warn(self, others: Sequence[str] = ()) -> None:
        """Warn of what does not belong; ``others`` are files whose run key is another than listed."""
        told = [
            _told(
                self.strangers,
                "not of the study as it is now and left out; `granstudy prune` removes such",
            ),
            _told(others, "of another run than the study has, and left out; run the study again"),
            _told(self.missing, "not there, as the study has not computed them yet"),
        ]
        if any(told):
            warnings.warn("; ".join(filter(None, told)), UserWarning, stacklevel=3)


def belonging(where: Where) -> Belonging:
    """The runs in a folder, of a glob pattern, or as given.

    In a folder, references and files of unfinished jobs are left out, and the study's list is held to.

    Raises
    ------
    FileNotFoundError
        If there are none.
    """
    if not isinstance(where, (str, Path)):
        found = Belonging([str(path) for path in where])
    elif Path(where).is_dir():
        found = _in_folder(Path(where))
    else:
        found = Belonging(sorted(glob.glob(str(where), recursive=True)))
    if not found.files:
        raise FileNotFoundError(f"{where}: no runs there")
    return found


def _in_folder(folder: Path) -> Belonging:
    """The runs in a folder, by the lists of the studies that they lie in."""
    found = [path for path in sorted(folder.rglob("*.nc"), key=str) if _counts(path, folder)]
    files = {Path(os.path.abspath(path)): str(path) for path in found}
    home = Path(os.path.abspath(folder))
    lists: dict[Path, dict[Path, str] | None] = {}
    keys: dict[Path, str] = {}
    for start in {home, *(path.parent for path in files), *_lists_below(home)}:
        keys |= _listed(start, lists) or {}
    strangers = {p for p in files if p not in keys and _listed(p.parent, lists) is not None}
    return Belonging(
        files=[name for path, name in files.items() if path not in strangers],
        keys={files[path]: key for path, key in keys.items() if path in files},
        strangers=[name for path, name in files.items() if path in strangers],
        missing=sorted(
            str(path)
            for path in keys
            if path not in files and path.is_relative_to(home) and _counts(path, home)
        ),
    )


def _counts(path: Path, folder: Path) -> bool:
    """Whether a file is a run that is asked for: no reference, and not half written or unfinished."""
    parts = path.relative_to(folder).parts
    return "reference" not in parts and not any(part.startswith(".") for part in parts)


def _lists_below(folder: Path) -> list[Path]:
    """Folders under a folder that hold a list, for studies none of whose runs are there."""
    return [path.parent for path in folder.rglob(LIST) if _counts(path, folder)]


def _listed(folder: Path, known: dict[Path, dict[Path, str] | None]) -> dict[Path, str] | None:
    """Files and run keys by the list in a folder or in the nearest one above; None where there is none.

    Parameters
    ----------
    known : dict
        What was found so far, by folder; it is extended.
    """
    if folder not in known:
        runs = _read(folder / LIST)
        if runs is not None:
            known[folder] = {folder / f"{run}.nc": key for run, key in runs.items()}
        else:
            above = folder.parent
            known[folder] = None if above == folder else _listed(above, known)
    return known[folder]


def _read(path: Path) -> Mapping[str, str] | None:
    """The runs of a list; None where there is no list, or the file is another."""
    try:
        content: Any = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    runs = content.get("runs") if isinstance(content, dict) and "study" in content else None
    return runs if isinstance(runs, dict) else None


def _told(files: Sequence[str], what: str) -> str:
    """How many files are what, and which first; "" for none."""
    if not files:
        return ""
    more = ", ..." if len(files) > NAMED else ""
    verb = "file is" if len(files) == 1 else "files are"
    return f"{len(files)} {verb} {what} ({', '.join(files[:NAMED])}{more})"
