"""The atlas of a study: all states to an accuracy as one dataset over state, dimension, λ and e."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.analysis.tables.markdown import github_table
from granstudy.analysis.tables.table import csv_table
from granstudy.datasets.netcdf import write_dataset
from granstudy.datasets.run_dataset import CONVENTIONS
from granstudy.datasets.unstack import unstack_runs
from granstudy.support.files import write_text
from granstudy.trust.flags import Trust, flag_word

WITH_ERRORS = {
    "a2": "estimated_a2_error",
    "a3": "estimated_a3_error",
    "cooling_coefficient": "estimated_cooling_coefficient_error",
    "tail_rate": "tail_rate_error",
    "far_slope": "far_slope_error",
}
"""Numbers of an atlas, and the column of their errors. In the atlas it is ``<number>_error``."""

OTHERS = ("far_speed", "a2_linear", "a2_divided", "cooling_coefficient_linear", "trust", "status")
"""What else an atlas has."""

AXES = ("state", "dim", "exponent", "e")
"""Dimensions of an atlas."""

ASKED = ("accuracy", "a2_accuracy")
"""Parameters that all states of an atlas share."""

LEAST = 3e-7
"""Least error that an atlas states of what is not exact. Held against finer grids, smaller estimates were too
small by up to a factor 6; those finer grids agree to some 2e-7 among themselves."""

LEAST_OF = {"a2": "", "a3": "", "cooling_coefficient": "", "tail_rate": "relative"}
"""Numbers whose errors are at least `LEAST`, or so much of the number; that of K is relative as it stands."""

EXACT = 1e-11
"""Errors below are those of exact moments."""

COMMENT = (
    "e = 1 has neither state: elastic collisions take no energy. Errors are estimated by the changes "
    "from grid to grid, and are 3e-7 at least; that of K is relative. At λ = 0 (Maxwell molecules) K, a2 "
    "and a3 are exact; a3 is missing where the sixth moment is infinite, and a2 is finite at every e. "
    "Collisions make T' = −ρK T^(1+λ/2), by the kernel C|g|^λ with C = strength. tail_rate follows from "
    "K, to leading order at large speeds; far_slope is what was seen at far_speed."
)
"""What a reader of an atlas has to know."""

HEADER = (
    "state", "d", "states", "trusted", "marginal", "untrusted",
    "median error of K", "of a2", "linear theory: a2 off by", "K off by",
)  # fmt: skip


def atlas_of(title: str, tables: Sequence[xr.Dataset]) -> xr.Dataset:
    """The atlas of tables of states to an accuracy.

    Parameters
    ----------
    title : str
    tables : sequence of xarray.Dataset
        From `granstudy.analysis.tables.states.state_table`; each of one state in one dimension.

    Returns
    -------
    xarray.Dataset
        Over `AXES`: `a2`, `a3`, `cooling_coefficient` (K), `tail_rate` and `far_slope`, each with its
        `.._error`; `far_speed`; a2 and K by linear theory; `trust` and `status`.

    Raises
    ------
    ValueError
        If tables differ in e and λ, or two are of the same state and dimension.
    """
    parts: dict[tuple[str, int], xr.Dataset] = {}
    for table in tables:
        key = table.attrs["state"], int(table.attrs["dim"])
        if key in parts:
            raise ValueError(f"two experiments have the {key[0]} state in {key[1]}D; leave one out")
        parts[key] = _part(table)
    first = next(iter(parts.values()))
    axes = [(part[name].values, first[name].values) for part in parts.values() for name in AXES[2:]]
    if not all(np.array_equal(one, other) for one, other in axes):
        raise ValueError("all states of an atlas must sweep the same values of e and exponent")
    states, dims = ([*dict.fromkeys(values)] for values in zip(*parts, strict=True))
    missing = [f"{state} {dim}D" for state in states for dim in dims if (state, dim) not in parts]
    if missing:
        raise ValueError(
            f"an atlas has every state in every dimension: {', '.join(missing)} is missing"
        )
    rows = [_joined([parts[state, dim] for dim in dims], "dim", ["strength"]) for state in states]
    atlas = _joined(rows, "state", []).transpose(*AXES)
    atlas = atlas.assign_coords(
        state=("state", states, {"long_name": "state that the gas approaches"}),
        dim=("dim", dims, {"long_name": "dimension d of velocities", "units": "1"}),
    )
    atlas.attrs = {
        "title": title,
        "Conventions": CONVENTIONS,
        "source": "granstudy, studies of kind state: Newton's method on radial grids",
        "comment": COMMENT,
        "swept": "e exponent",
    }
    return atlas


def _joined(parts: Sequence[xr.Dataset], dim: str, along: list[str]) -> xr.Dataset:
    """Parts along a new dimension; the coordinates ``along`` it differ, all others are alike."""
    return xr.concat(
        parts,
        dim,
        data_vars="all",
        coords=[name for name in along if name in parts[0].coords],
        compat="override",
        combine_attrs="override",
    )


def _part(table: xr.Dataset) -> xr.Dataset:
    """One table over λ and e, with the names of an atlas."""
    names = {column: f"{name}_error" for name, column in WITH_ERRORS.items()}
    pairs = [n for pair in WITH_ERRORS.items() for n in pair]
    kept = table[[n for n in (*pairs, *OTHERS) if n in table]].rename(names)
    shared = [n for n in ASKED if n in table.coords]
    kept = kept.drop_vars([n for n in kept.coords if n not in (*AXES, *shared)])
    part = unstack_runs(kept, ["exponent", "e"])
    for name, unit in LEAST_OF.items():
        error = part[f"{name}_error"]
        least = LEAST * (abs(part[name]) if unit == "relative" else 1.0)
        part[f"{name}_error"] = error.where(~((error > EXACT) & (error < least)), least)
    for name in WITH_ERRORS:
        part[name].attrs["ancillary_variables"] = f"{name}_error"
    if "a2_divided" not in part:
        nothing = part["a2"].copy(data=np.full(part["a2"].shape, np.nan))
        part["a2_divided"] = nothing.assign_attrs(
            long_name="a2 by the theory linear in it after division by 1 + a2",
            ancillary_variables="",
        )
    if "strength" in table.coords:
        part = part.assign_coords(strength=table["strength"].variable)
    for variable in part.variables.values():
        for name in ("format", "quantity"):
            variable.attrs.pop(name, None)
    return part


def write_atlas(atlas: xr.Dataset, nc: str | Path, csv: str | Path, md: str | Path) -> None:
    """Write an atlas as NetCDF, CSV (a line a state) and Markdown (its summary), each whole or not at all."""
    write_dataset(atlas, nc, sidecar=False)
    write_text(Path(csv), csv_table(_lines(atlas)))
    write_text(Path(md), markdown_atlas(atlas))


def _lines(atlas: xr.Dataset) -> xr.Dataset:
    """An atlas as a table, a run a state."""
    lines = atlas.stack(run=AXES).reset_index("run").drop_vars("strength", errors="ignore")
    return lines.assign_attrs(swept=" ".join(AXES))


def markdown_atlas(atlas: xr.Dataset) -> str:
    """Title, a line for each state and dimension, what to know, and the states that are not trusted."""
    rows, doubtful = [], []
    for state in atlas["state"].values:
        for dim in atlas["dim"].values:
            part = atlas.sel(state=state, dim=dim)
            rows.append([str(state), str(dim), str(part["trust"].size), *_summary(part)])
            doubtful += _doubtful(part, f"{state}, {dim}D")
    table = github_table(HEADER, rows, ["left"] + ["right"] * (len(HEADER) - 1))
    parts = [f"# {atlas.attrs['title']}", "", table, "", atlas.attrs["comment"], ""]
    if doubtful:
        parts += ["States that are not trusted:", "", *doubtful]
    return "\n".join(parts) + "\n"


def _summary(part: xr.Dataset) -> list[str]:
    """Labels, errors, and how far the linear theories are off at most."""
    counts = Counter(int(label) for label in part["trust"].values.ravel())
    labels = [str(counts[label]) for label in (Trust.TRUSTED, Trust.MARGINAL, Trust.UNTRUSTED)]
    errors = [part["cooling_coefficient_error"], part["a2_error"]]
    off = abs(part["a2_linear"] - part["a2"])
    K_off = abs(part["cooling_coefficient_linear"] / part["cooling_coefficient"] - 1.0)
    return [
        *labels,
        *(f"{float(np.nanmedian(error)):.1e}" for error in errors),
        f"{float(off.max()):.2g}",
        f"{float(K_off.max()):.1e}",
    ]


DOUBTFUL = ("exponent", "e", "a2", "a2_error", "cooling_coefficient_error")
"""What is said of a state that is not trusted."""


def _doubtful(part: xr.Dataset, name: str) -> list[str]:
    """A line for each state that is not trusted."""
    found = []
    for i, j in np.argwhere(part["trust"].values != Trust.TRUSTED):
        one = part.isel(exponent=i, e=j)
        exponent, e, a2, error, K_error = (float(one[n]) for n in DOUBTFUL)
        found.append(
            f"- {name}, λ = {exponent:g}, e = {e:g}: {flag_word('trust', one['trust'])}, "
            f"a2 = {a2:.6f} ± {error:.1e}, K to {K_error:.1e}"
        )
    return found
