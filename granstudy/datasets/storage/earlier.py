"""Files of earlier granstudies: NetCDF-4, with a checksum of the values."""

import hashlib
import json
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.datasets.storage.checksum import damaged

HDF5 = b"\x89HDF"
"""First bytes of their files."""


def read_earlier(path: str | Path) -> xr.Dataset:
    """Read a dataset of an earlier granstudy into memory, and verify its checksum; the file is closed.

    Raises
    ------
    DamagedFileError
        If the file is damaged, or granstudy did not write it.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4", cache=False) as stored:
            ds = stored.load()
        found = payload_checksum(ds)
    # The libraries raise whatever a damaged byte leads them to.
    except Exception as error:
        raise damaged(path, f"{type(error).__name__}: {error}") from error
    expected = ds.attrs.get("payload_sha256")
    if expected is None:
        raise damaged(path, "it has no checksum")
    if found != expected:
        raise damaged(path, "its contents do not match its checksum")
    return ds


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
