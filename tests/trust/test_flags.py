"""Flags as variables that say what their numbers mean."""

import numpy as np
import xarray as xr

from granstudy.trust.flags import FLAGS, Status, Trust, flag_variable, flag_word


def test_a_flag_says_all_its_numbers_and_words():
    ds = xr.Dataset({"status": flag_variable(Status.DIVERGED, "how it ended", reason="too hot")})
    flag = ds["status"]
    assert flag.dtype == np.int8 and flag_word("status", flag) == "diverged"
    assert flag.attrs["flag_values"].tolist() == [status.value for status in Status]
    assert flag.attrs["flag_meanings"] == "missing ok failed diverged stopped"
    assert flag.attrs["reason"] == "too hot"


def test_every_flag_has_words():
    assert flag_word("trust", 2) == "trusted"
    assert FLAGS == {"status": Status, "trust": Trust}
