"""Tables of random runs beside their truths: what labels and estimates are worth, by kind of gas and run."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.analysis.columns import computed
from granstudy.analysis.source import Row, TableSource
from granstudy.analysis.tables.markdown import github_table
from granstudy.datasets.netcdf import read_dataset, run_seconds
from granstudy.datasets.open_runs import final_values
from granstudy.study.run import Run
from granstudy.trust.flags import Status, Trust, flag_word
from granstudy.trust.rules import RULES, SMALL, Judged
from granstudy.trust.truth import Errors
from granstudy.velocity.symmetry import Symmetry

KIND = ("gas", "frame", "method")
"""Coordinates that say of which kind a random run is; `method` is the one asked for."""

KNOWN = (
    *("scene", "restitution", "exponent", "diffusion", "scheme", "conserve"),
    *("N", "R", "t_final"),
)
"""Parameters of every run that its row has beside its seed and its kind."""

QUANTITIES = ("temperature", "a2")

NUMBERS = tuple(
    name
    for quantity in QUANTITIES
    for name in (
        f"largest_{quantity}_error",
        f"{quantity}_error_estimate",
        f"{quantity}_known_to",
    )
)
"""Numbers of a random run (`granstudy.runs.labels.labelled`)."""

FLAGS = ("ended", "trust", "status")
"""Flags of a random run."""

QUANTILES = (0.0, 0.01, 0.05, 0.5, 0.95, 0.99, 1.0)
"""Quantiles of estimate over error that are shown."""

BROKEN = {
    "trusted_wrong": "trusted, and off by more than 1% in T or 0.01 in a2",
    "untrusted_right": "untrusted, and both errors under 1e-6",
    "underestimated": "an error above 1e-6 and three times its estimate",
    "overestimated": "an error above 1e-6 and a hundredth of its estimate",
}
"""The rules in words, by what breaks them."""


def labels_table(source: TableSource) -> xr.Dataset:
    """A row for each random run: its kind, `NUMBERS`, label, the rules that it breaks, seconds, `status`."""
    files = [row.file for row in source.rows]
    others: dict[str, Sequence[Any]] = {
        "truth": [str(read_dataset(file).attrs.get("truth", "")) for file in files],
        "seconds": [run_seconds(file) for file in files],
    }
    return labels_columns(source.rows, final_values(files), others)


def labels_columns(
    rows: Sequence[Row], last: xr.Dataset, others: Mapping[str, Sequence[Any]]
) -> xr.Dataset:
    """The table of random runs, from their numbers, and columns that are no variables of theirs.

    A run that failed has no numbers, and breaks no rule. `temperature_ratio` and `a2_ratio` are estimate over
    error, NaN where the error is not surely above 1e-6.
    """
    runs = [row.run for row in rows]
    table = xr.Dataset({name: last[name].variable for name in (*NUMBERS, *FLAGS)})
    found = [_judged(run, table.isel(run=i)) for i, run in enumerate(runs)]
    for quantity in QUANTITIES:
        ratios = [np.nan if one is None else getattr(one.ratios, quantity) for one in found]
        table[f"{quantity}_ratio"] = computed(f"{quantity}_ratio", ratios, of=quantity)
    broken = [" ".join(one.broken) if one is not None else "" for one in found]
    ended = [one is not None and one.ended for one in found]
    columns = {"ended": ended, "broken": np.array(broken, dtype=object), **others}
    for name, values in columns.items():
        table[name] = computed(name, values)
    table = table.assign_coords({name: ("run", v) for name, v in _coordinates(runs).items()})
    table.attrs["swept"] = " ".join(("seed", *KIND, *KNOWN))
    shown = []
    for quantity in QUANTITIES:
        shown += [name for name in NUMBERS if quantity in name] + [f"{quantity}_ratio"]
    return table[[*shown, "trust", "ended", "broken", *others, "status"]]


def _judged(run: Run, row: xr.Dataset) -> Judged | None:
    """A run beside its truth; None for a run that failed."""
    if int(row["status"]) != Status.OK:
        return None
    return Judged(
        Trust(int(row["trust"])),
        bool(row["ended"]),
        Errors(*(float(row[f"largest_{name}_error"]) for name in QUANTITIES)),
        Errors(*(float(row[f"{name}_error_estimate"]) for name in QUANTITIES)),
        Errors(*(float(row[f"{name}_known_to"]) for name in QUANTITIES)),
        run.solver.traits.by_particles,
    )


def gas(run: Run) -> str:
    """What gas a random run is of, in words."""
    full = Symmetry.named(run.scene.dim, "full")
    return f"{run.scene.dim}D, {'' if run.scene.symmetry == full else 'not '}isotropic"


def _coordinates(runs: Sequence[Run]) -> dict[str, np.ndarray]:
    """Seed, kind and parameters of random runs."""
    rows = [_parameters(run) for run in runs]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def _parameters(run: Run) -> dict[str, Any]:
    assert run.time is not None
    times = run.time.coordinates()
    if run.solver.traits.by_particles:
        times |= dict.fromkeys(("frame", "scheme", "conserve"), "")
    law = run.scene.restitution
    found = {
        **run.scene.coordinates(),
        **times,
        "seed": dict(run.values)["seed"],
        "gas": gas(run),
        "method": run.solver.method,
        "restitution": repr(law) if callable(law) else f"{law:g}",
        "N": run.solver.N,
        "R": run.solver.R,
    }
    return {name: found[name] for name in ("seed", *KIND, *KNOWN)}


def markdown_labels(table: xr.Dataset) -> str:
    """Title, the rules, a line a kind, quantiles of estimate over error, and every run that breaks a rule."""
    parts = [
        f"# {table.attrs['title']}",
        _rules(table),
        _kinds(table),
        "Estimate over error, where the error is surely above 1e-6 (one above 0.1 counts as 0.1):",
        _quantiles(table),
        _truths(table),
        _breaking(table),
        _failed(table),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _rules(table: xr.Dataset) -> str:
    """Count the runs that break a rule, by rule."""
    counts = _broken_counts(table)
    runs, broken = table.sizes["run"], int(np.count_nonzero(table["broken"].values != ""))
    lines = [[text, str(counts[name])] for name, text in BROKEN.items()]
    rows = github_table(["rule, by what breaks it", "runs"], lines, ["left", "right"])
    return f"{broken} of {runs} random runs break a rule.\n\n{rows}"


def _broken_counts(table: xr.Dataset) -> Counter[str]:
    return Counter(name for text in table["broken"].values for name in str(text).split())


def _kinds(table: xr.Dataset) -> str:
    """A line a kind: how many runs, labels, breaks, and least, median and largest estimate over error."""
    keys = list(zip(*(table[name].values for name in KIND), strict=True))
    lines = []
    for key in sorted(set(keys)):
        part = table.isel(run=[i for i, other in enumerate(keys) if other == key])
        lines.append([key[0], key[1] or "–", key[2], *_counts(part), *_ranges(part)])
    lines.append(["**all**", "", "", *_counts(table), *_ranges(table)])
    labels = ("trusted", "marginal", "untrusted", "stopped", "failed")
    header = [*KIND, "runs", *labels, *(name.replace("_", ", ") for name in RULES), "T", "a2"]
    rows = github_table(header, lines, ["left"] * 3 + ["right"] * (len(header) - 3))
    legend = (
        "stopped: before the final time, untrusted. failed: before the start. T, a2: least, median and "
        "largest estimate over error. The estimates of `dsmc` are two standard errors: an error may be five "
        "of them, and is underestimated beyond; it is never overestimated."
    )
    return f"{rows}\n\n{legend}"


def _counts(part: xr.Dataset) -> list[str]:
    ok, ended = part["status"].values == Status.OK, part["ended"].values
    labels = [
        int(np.sum(ok & ended & (part["trust"].values == trust)))
        for trust in (Trust.TRUSTED, Trust.MARGINAL, Trust.UNTRUSTED)
    ]
    counts = _broken_counts(part)
    stopped, failed = int(np.sum(ok & ~ended)), int(np.sum(~ok))
    numbers = [part.sizes["run"], *labels, stopped, failed, *(counts[name] for name in RULES)]
    return [str(number) for number in numbers]


def _ranges(part: xr.Dataset) -> list[str]:
    found = []
    for quantity in QUANTITIES:
        ratios = part[f"{quantity}_ratio"].values
        ratios = ratios[np.isfinite(ratios)]
        numbers = (ratios.min(), np.median(ratios), ratios.max()) if ratios.size else ()
        found.append(", ".join(f"{number:.2g}" for number in numbers))
    return found


def _quantiles(table: xr.Dataset) -> str:
    """Quantiles of estimate over error, of runs on grids and by particles."""
    by_particles = table["method"].values == "dsmc"
    lines = []
    for name, there in (("on a grid", ~by_particles), ("by particles", by_particles)):
        for quantity in QUANTITIES:
            ratios = table[f"{quantity}_ratio"].values[there]
            ratios = ratios[np.isfinite(ratios)]
            if ratios.size:
                numbers = [f"{number:.2g}" for number in np.quantile(ratios, QUANTILES)]
                lines.append([f"{quantity}, {name}", str(ratios.size), *numbers])
    heads = ["least", *(f"{q:.0%}" for q in QUANTILES[1:-1]), "largest"]
    return github_table(["", "runs", *heads], lines, ["left", *["right"] * (1 + len(heads))])


def _truths(table: xr.Dataset) -> str:
    """How many runs have which truth, and how many of those are known well by it."""
    ok = table["status"].values == Status.OK
    well = np.full(table.sizes["run"], True)
    for quantity in QUANTITIES:
        least = np.maximum(SMALL, table[f"largest_{quantity}_error"].values / 10)
        well &= table[f"{quantity}_known_to"].values <= least
    kinds = np.array([_kind_of_truth(str(text)) for text in table["truth"].values])
    lines = [
        [kind, str(np.sum(ok & (kinds == kind))), str(np.sum(ok & well & (kinds == kind)))]
        for kind in sorted(set(kinds[ok]))
    ]
    header = ["truth", "runs", "known to a tenth of both errors, or to 1e-6"]
    return github_table(header, lines, ["left", "right", "right"])


def _kind_of_truth(text: str) -> str:
    if text.startswith("dsmc"):
        return "particles"
    return text if text == "exact law" else "a finer run"


def _breaking(table: xr.Dataset) -> str:
    """Every run that breaks a rule: seed, rule, label, errors with estimates, kind and parameters."""
    lines = []
    for i in np.flatnonzero(table["broken"].values != ""):
        row = table.isel(run=int(i))
        cells = [
            f"{float(row[f'largest_{name}_error']):.1e} ({float(row[f'{name}_error_estimate']):.1e})"
            for name in QUANTITIES
        ]
        what = [f"{name}={row[name].item()}" for name in (*KIND, *KNOWN) if row[name].item() != ""]
        label = flag_word("trust", row["trust"])
        seed = str(row["seed"].item())
        lines.append([seed, row["broken"].item(), label, *cells, ", ".join(what)])
    if not lines:
        return ""
    header = ["seed", "breaks", "label", "error of T (estimate)", "error of a2 (estimate)", "run"]
    return github_table(header, lines, ["right", "left", "left", "right", "right", "left"])


def _failed(table: xr.Dataset) -> str:
    """The seeds of runs that failed before they had numbers."""
    failed = table["seed"].values[table["status"].values != Status.OK]
    if not failed.size:
        return ""
    seeds = ", ".join(map(str, failed))
    return f"Seeds of runs that failed, a tolerance that their grid cannot hold: {seeds}."
