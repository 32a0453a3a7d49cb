"""NetCDF files that appear whole or not at all, with a checksum of what they hold."""

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


def payload_checksum(ds: xr.Dataset) -> str:
    """SHA-256 over names, dimensions and bytes of all variables."""
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


def write_dataset(
    ds: xr.Dataset, path: str | Path, duration: float | None = None, sidecar: bool = True
) -> None:
    """Write a dataset to NetCDF, whole or not at all, with a checksum of its payload.

    The file is written beside the target, synchronised and renamed. What varies from run to run (time,
    host, ``duration`` in seconds) goes to ``<path>.json``, so that the same run gives the same bytes;
    ``sidecar=False`` leaves that out.
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


def _write_sidecar(path: Path, duration: float | None) -> None:
    content = {
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
        "host": platform.node(),
        "duration_seconds": duration,
    }
    write_whole(path, lambda partial: partial.write_text(json.dumps(content, indent=1) + "\n"))


def read_dataset(path: str | Path) -> xr.Dataset:
    """Read a dataset into memory and verify its checksum.

    Raises
    ------
    ValueError
        If the file has no checksum or holds another payload than was written.
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
    """Wall time of the run in a file, set-up included, by its sidecar."""
    return float(json.loads(Path(f"{file}.json").read_text())["duration_seconds"])
