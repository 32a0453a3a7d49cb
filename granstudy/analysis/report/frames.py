"""Frames of pages, in Jinja's language."""

import hashlib
from math import isnan
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from granstudy.support.reporter import duration

TEMPLATES = Path(__file__).parent / "templates"
"""Frames of pages, and their style."""


def frames() -> Environment:
    """The frames, by their names; a name that a frame does not get is an error."""
    found = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters["seconds"] = _seconds
    return found


def frames_digest() -> str:
    """A hash over the frames: a page depends on them as on code."""
    files = sorted(path for path in TEMPLATES.iterdir() if path.is_file())
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()


def _seconds(seconds: float) -> str:
    """A measured time: to three digits below a minute, then in words."""
    if isnan(seconds):
        return "–"
    return f"{seconds:.3g} s" if seconds < 60 else duration(seconds)
