"""What a report says of the runs of a study: labels, failures, times, versions."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.analysis.labels import run_text
from granstudy.datasets.netcdf import read_dataset
from granstudy.runs.store import sidecar
from granstudy.study.layout import Layout
from granstudy.support.files import read_json
from granstudy.trust.flags import flag_word

LABELS = ("trusted", "marginal", "untrusted", "failed", "unlabelled")
"""Labels of runs in the order in which they are counted."""


@dataclass(frozen=True)
class RunFact:
    """One run.

    Attributes
    ----------
    experiment, name : str
        Where it stands in the study.
    key : str
        Its key in the store; "" for a run of a benchmark, which has none.
    label : str
        One of `LABELS`.
    status : str
        How it ended, in a word.
    reasons : tuple of str
        Why it ended early; of one that did not, why it is not trusted.
    seconds : float
        Wall time; NaN where it was not measured.
    written : str
        When it was computed, as ISO 8601; "" where it is not known.
    """

    experiment: str
    name: str
    key: str
    label: str
    status: str
    reasons: tuple[str, ...]
    seconds: float
    written: str


@dataclass(frozen=True)
class Counts:
    """Runs of an experiment, or of all: how many, by label, and the sum of their seconds."""

    name: str
    runs: int
    labels: tuple[int, ...]
    seconds: float

    @classmethod
    def of(cls, name: str, runs: Sequence[RunFact]) -> "Counts":
        """Count runs."""
        labels = Counter(run.label for run in runs)
        known = [run.seconds for run in runs if np.isfinite(run.seconds)]
        return cls(name, len(runs), tuple(labels[label] for label in LABELS), sum(known))


def run_facts(layout: Layout, name: str) -> list[RunFact]:
    """The runs of an experiment, references and truths among them; none where its dataset is missing."""
    if not Path(layout.dataset(name)).is_file():
        return []
    runs = read_dataset(layout.dataset(name))
    if layout.study.is_timed(name):
        return [_fact(runs.isel(run=i), name, _row_name(runs, i)) for i in range(runs.sizes["run"])]
    rows = {key: i for i, key in enumerate(runs["run_key"].values.tolist())}
    return [
        _fact(runs.isel(run=rows[key]), name, path, key, layout.store.path(key))
        for path, key in read_json(layout.complete(name)).items()
        if key in rows
    ]


def _fact(
    run: xr.Dataset, experiment: str, name: str, key: str = "", file: Path | None = None
) -> RunFact:
    status = flag_word("status", run["status"])
    label = "failed"
    if status == "ok":
        label = flag_word("trust", run["trust"]) if "trust" in run else "unlabelled"
    told = "reason" if status != "ok" else "trust_reasons"
    reasons = str(run[told].item()) if told in run and label != "trusted" else ""
    beside = read_json(sidecar(file)) if file is not None else {}
    seconds = beside.get("duration_seconds")
    return RunFact(
        experiment=experiment,
        name=name,
        key=key,
        label=label,
        status=status,
        reasons=tuple(reasons.splitlines()),
        seconds=float("nan") if seconds is None else float(seconds),
        written=str(beside.get("written", "")),
    )


def _row_name(runs: xr.Dataset, row: int) -> str:
    """A run of a benchmark by the parameters that tell it from others."""
    swept = [str(name) for name, c in runs.coords.items() if c.dims == ("run",)]
    return run_text({name: runs[name].values[row].item() for name in swept})


def computed_by(layout: Layout, names: Iterable[str]) -> tuple[dict[str, str], list[str]]:
    """Versions of libraries that the runs were computed with, and commits of granstudy.

    Several versions of one library stand in one text, each once, with commas.
    """
    versions: dict[str, dict[str, None]] = {}
    commits: dict[str, None] = {}
    for name in names:
        if not Path(layout.dataset(name)).is_file():
            continue
        runs = read_dataset(layout.dataset(name))
        for text in _told(runs, "versions"):
            for library, version in json.loads(text).items():
                versions.setdefault(library, {})[version] = None
        commits |= dict.fromkeys(_told(runs, "git_commit"))
    return {library: ", ".join(found) for library, found in sorted(versions.items())}, list(commits)


def _told(runs: xr.Dataset, name: str) -> list[str]:
    """What runs say of themselves: an attribute where all say the same, else a variable."""
    said = [runs.attrs[name]] if name in runs.attrs else []
    if name in runs.variables:
        said = runs[name].values.ravel().tolist()
    return [str(text) for text in dict.fromkeys(said) if text]
