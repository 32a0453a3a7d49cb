"""Floating-point errors are errors in every test (code that Numba compiled is not affected)."""

import dask
import numpy as np

np.seterr(all="raise", under="ignore")

# netCDF4 under Dask's threads crashed once in some hundred runs; the tests must not.
dask.config.set(scheduler="synchronous")
