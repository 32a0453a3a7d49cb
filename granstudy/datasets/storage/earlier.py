"""Files of earlier granstudies: NetCDF-4, with a checksum of the values.

The HDF5 library, which reads them, hangs or crashes on some damaged files. So a process of its own reads a
file first, within a time limit. What that process has verified is then safe to read here. It takes about half
a second a file; `granstudy.write_dataset` writes what was read in today's format, which takes milliseconds.
"""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.datasets.storage.checksum import damaged

SECONDS, BYTES_A_SECOND = 60.0, 1e7
"""Seconds that reading a file may take, and bytes for which one more is given."""

REFUSED = 3
"""Exit status of the process that reads a file first, where it raises an error."""

HDF5 = b"\x89HDF"
"""First bytes of their files."""


def read_earlier(path: str | Path) -> xr.Dataset:
    """Read a dataset of an earlier granstudy into memory, and verify its checksum; the file is closed.

    Raises
    ------
    DamagedFileError
        If the file is damaged, or granstudy did not write it; if the library crashes on it, or has not
        read it after `SECONDS`, and one more for each `BYTES_A_SECOND`.
    """
    _verify_apart(Path(path))
    return _read(path)


def _verify_apart(path: Path) -> None:
    """Read and verify a file in a process of its own, with an end to its time."""
    limit = SECONDS + path.stat().st_size / BYTES_A_SECOND
    folders = os.pathsep.join(filter(None, sys.path))
    try:
        done = subprocess.run(
            [sys.executable, "-m", __name__, str(path.absolute())],
            env=os.environ | {"PYTHONPATH": folders},
            capture_output=True,
            text=True,
            timeout=limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise damaged(
            path, f"the HDF5 library does not end reading it within {limit:.0f} s"
        ) from None
    if done.returncode == REFUSED:
        raise damaged(path, done.stdout.strip())
    if done.returncode != 0:
        raise damaged(path, f"the HDF5 library ends with status {done.returncode} while reading it")


def _read(path: str | Path) -> xr.Dataset:
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


if __name__ == "__main__":
    try:
        _read(sys.argv[1])
    except ValueError as refusal:
        print(refusal)
        sys.exit(REFUSED)
