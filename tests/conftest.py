"""Floating-point errors are errors in every test (code that Numba compiled is not affected)."""

import numpy as np

np.seterr(all="raise", under="ignore")
