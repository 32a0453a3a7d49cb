"""Printed numbers beside ours."""

import numpy as np
import pytest
import xarray as xr

from granstudy.analysis.paper.printed import paper_table, with_paper


@pytest.fixture
def table_3():
    """Runs with 4/9 of Table 3's numbers, and one that the paper does not have."""
    printed = paper_table(3)
    sizes = [*printed["M_sph"], 50]
    errors = [*printed["temperature_error"] / 2.25, 1e-6]
    coords = {"M_sph": ("run", sizes), "sphere_rule": ("run", ["design"] * len(sizes))}
    attrs = {"long_name": "error", "units": "1"}
    return xr.Dataset({"paper_temperature_error": ("run", errors, attrs)}, coords)


def test_table_3_stands_beside_nine_quarters_of_ours(table_3):
    table = with_paper(table_3, "table3", "paper_temperature_error")
    np.testing.assert_allclose(table["ratio"][:-1], 1.0, rtol=1e-14)
    np.testing.assert_allclose(table["as_printed"][:-1], table["paper"][:-1], rtol=1e-14)
    assert "times 2.25" in table["as_printed"].attrs["long_name"]
    assert not table["has_paper"][-1] and np.isnan(table["ratio"][-1])


def test_other_tables_are_printed_as_they_are(table_3):
    table = with_paper(table_3, "table6", "paper_temperature_error")
    assert "as_printed" not in table
    assert table["paper"].attrs["factor"] == 1.0
    np.testing.assert_allclose(
        table["ratio"][0], table_3["paper_temperature_error"][0] / table["paper"][0]
    )
