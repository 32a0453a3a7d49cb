"""NetCDF files of runs: written whole or not at all, with a checksum of what they hold."""

import hashlib
import json
import platform
from collections.abc import Hashable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy.support.files import write_whole


def write_dataset(
    ds: xr.Dataset, path: str | Path, duration: float | None = None, sidecar: bool = True
) -> None:
    """Write a dataset to a NetCDF file, whole or not at all, with a checksum of its payload.

    The same run gives the same bytes: what varies from run to run goes to a JSON file beside it.

    Parameters
    ----------
    ds : xarray.Dataset
    path : str or Path
        Folders above it are made where they are missing.
    duration : float, optional
        Wall time of the run in seconds.
    sidecar : bool
        Whether ``<path>.json`` is written too: time of writing, host and ``duration``.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    ds = ds.assign_attrs(payload_sha256=payload_checksum(ds))
    encoding: dict[Hashable, Any] = {
        name: {"zlib": True, "complevel": 1, "shuffle": True, "_FillValue": None}
        for name, variable in ds.variables.items()
        if variable.dtype.kind == "f" and variable.ndim > 0
    }
    if sidecar:
        _write_sidecar(path.with_name(path.name + ".json"), duration)
    write_whole(path, lambda partial: ds.to_netcdf(partial, engine="netcdf4", encoding=encoding))


def read_dataset(path: str | Path) -> xr.Dataset:
    """Read a dataset into memory, and verify its checksum.

    Raises
    ------
    ValueError
        If the file has no checksum, or does not match it.
    """
    with xr.open_dataset(path, engine="netcdf4") as stored:
        ds = stored.load()
    expected = ds.attrs.get("payload_sha256")
    if expected is None:
        raise ValueError(f"{path}: has no payload_sha256; granstudy did not write it")
    if payload_checksum(ds) != expected:
        raise ValueError(f"{path}: its payload does not match its checksum; the file is damaged")
    return ds


def run_seconds(file: str) -> float:
    """Wall time in seconds of the run in a file, set-up included; the JSON file beside it says."""
    return float(json.loads(Path(f"{file}.json").read_text())["duration_seconds"])


def payload_checksum(ds: xr.Dataset) -> str:
    """SHA-256, in hexadecimal, over names, dimensions and bytes of all variables."""
    digest = hashlib.sha256()
    for name in sorted(map(str, ds.variables)):
        variable = ds.variables[name]
        values = np.ascontiguousarray(variable.values)
        if values.dtype.kind in "OUST":
            content = json.dumps(values.tolist()).encode()
        else:
            content = values.tobytes()
        digest.update(f"{name}{variable.dims}".encode())
        digest.update(content)
    return digest.hexdigest()


def _write_sidecar(path: Path, duration: float | None) -> None:
    """Write what varies from run to run."""
    content = {
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
        "host": platform.node(),
        "duration_seconds": duration,
    }
    write_whole(path, lambda partial: partial.write_text(json.dumps(content, indent=1) + "\n"))
