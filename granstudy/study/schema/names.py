"""Names that become those of files and folders: experiments, study files, the points of a sweep."""

import re
from collections.abc import Iterable
from pathlib import Path

from granstudy.study.schema.values import shown

MAP = "map"
"""What the files of a study's map are called; no experiment can have that name."""

ATLAS = "atlas"
"""What the files of a study's atlas are called; no experiment can have that name."""

TAKEN = (MAP, ATLAS, "reference")
"""Names of other things that lie beside experiments and their runs."""

LONGEST = 64
"""Characters of a name at most."""

LONGEST_PART, LONGEST_PATH = 200, 1000
"""Characters of a folder's name and of a whole path in a study's results; file systems take 255 and 4096."""

_EXPERIMENT = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
_STUDY = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


def check_experiment_names(names: Iterable[str]) -> None:
    """Raise ValueError, one line a name, unless all names can be those of files beside each other."""
    lines = []
    seen: dict[str, str] = {}
    for name in names:
        where = f".{shown(name)}"
        if not _EXPERIMENT.fullmatch(name) or len(name) > LONGEST:
            lines.append(
                f"{where}: is no name of an experiment; allowed are letters a to z, digits, _ and -, the "
                f"first a letter or a digit, {LONGEST} at most"
            )
        elif name.lower() in TAKEN:
            lines.append(f"{where}: is taken, as are {', '.join(TAKEN)}; take another name")
        elif name.lower() in seen:
            lines.append(f"{where}: is {seen[name.lower()]!r} but for capitals; take another name")
        seen[name.lower()] = name
    if lines:
        raise ValueError("\n".join(lines))


def check_study_name(path: str | Path) -> None:
    """Raise ValueError unless a study file's name can be that of the folder of its results."""
    stem = Path(path).stem
    if not _STUDY.fullmatch(stem) or len(stem) > LONGEST:
        raise ValueError(
            f"{path}: {shown(stem)} is no name of a study, whose results lie in a folder of that name; "
            f"allowed are letters a to z, digits, _, - and ., first a letter or a digit, {LONGEST} at most"
        )


def check_run_path(path: str) -> None:
    """Raise ValueError unless a file system takes the path of a run."""
    for part in path.split("/"):
        if len(part) > LONGEST_PART:
            word, _, value = part.partition("~")
            raise ValueError(
                f"{word}: value {shown(value)}: has {len(value)} characters in the name of a folder; must "
                f"have {LONGEST_PART - len(word) - 1} at most"
            )
    if len(path) > LONGEST_PATH:
        raise ValueError(
            f"sweep: the path {shown(path)} has {len(path)} characters; must have {LONGEST_PATH} at most; "
            "sweep fewer parameters"
        )
