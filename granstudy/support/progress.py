"""Progress of a computation: a bar where a person watches, or a function that is called."""

import sys
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tqdm import tqdm

Progress = bool | Callable[[int, int, float], None] | None
"""What to do with progress: show a bar or not, call a function of (done, total, time), or, by None, show a
bar where a person watches."""

Report = Callable[[int, float], None]
"""Function of (done, time) that a computation calls after each of its steps."""

PAUSE = 0.1
"""Seconds between two calls of a progress function at least, unless more was done in between."""


@contextmanager
def watched(progress: Progress, total: int) -> Iterator[Report]:
    """Watch a computation of ``total`` steps; yields the function that it calls with what is done.

    Parameters
    ----------
    progress : bool, callable or None
        A callable is called at every new value of done, and at most every `PAUSE` at the same one.
    total : int
        The last value of done.

    Raises
    ------
    ValueError
        If ``progress`` is something else.
    """
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise ValueError(
            f"progress={progress!r}: must be True, False, None, or a function of (done, total, time)"
        )
    if callable(progress):
        yield _called(progress, total)
        return
    hidden = not (person_watches() if progress is None else progress)
    with kind_of_bar()(total=total, disable=hidden) as bar:

        def report(done: int, time: float) -> None:
            bar.update(done - bar.n)

        yield report


def person_watches() -> bool:
    """Whether somebody sees a bar: in a terminal, or in a Jupyter notebook."""
    return in_notebook() or sys.stderr.isatty()


def in_notebook() -> bool:
    """Whether the interpreter is the kernel of a notebook."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and "IPKernelApp" in shell.config


def _called(progress: Callable[[int, int, float], None], total: int) -> Report:
    """The report that calls ``progress``, not too often."""
    last, called = -1, -PAUSE

    def report(done: int, time: float) -> None:
        nonlocal last, called
        now = clock.monotonic()
        if done > last or now - called >= PAUSE:
            last, called = done, now
            progress(done, total, time)

    return report


def kind_of_bar() -> Callable[..., tqdm]:
    """Kind of bar: one of text, but for notebooks with ipywidgets.

    `tqdm.auto` would warn in notebooks without ipywidgets, where text does as well.
    """
    if in_notebook():
        from tqdm import notebook  # it imports IPython and ipywidgets

        if getattr(notebook, "IProgress", None) is not None:  # None without ipywidgets
            return notebook.tqdm
    return tqdm
