"""The front of speed against error."""

import numpy as np
import pytest
import xarray as xr

from granstudy.analysis.figures.front import draw_front
from granstudy.analysis.labels import families
from granstudy.analysis.tables.fits import growth_exponent
from granstudy.study.benchmark.front import fastest_within, on_front

SECONDS = np.array([1.0, 2.0, 0.5, 4.0, np.nan, 0.5])
ERROR = np.array([1e-2, 1e-3, 1e-1, 1e-3, 1e-9, 1e-1])


def test_a_run_is_on_the_front_unless_another_is_as_good_in_both_and_better_in_one():
    # the fourth is as exact as the second and slower; two equal runs do not beat each other
    assert on_front(SECONDS, ERROR).tolist() == [True, True, True, False, False, True]


def test_the_fastest_run_within_an_error():
    assert fastest_within(SECONDS, ERROR, 1e-2) == 0
    assert fastest_within(SECONDS, ERROR, 1e-3) == 1
    assert fastest_within(SECONDS, ERROR, 1e-4) is None


def test_the_exponent_of_a_power_leaves_out_what_is_too_small_to_measure():
    N = np.array([8, 16, 32, 64])
    assert growth_exponent(N, 3.0 * N**2.5) == pytest.approx(2.5)
    assert growth_exponent(N, np.array([9.0, 16.0**3, 32.0**3, 64.0**3]), 10.0) == pytest.approx(3)
    assert np.isnan(growth_exponent(N, np.array([0.0, 0.0, np.nan, 20.0]), 10.0))


@pytest.fixture
def table():
    """A front as `experiment_table` makes it; a tolerance that failed, and one thread beside two."""
    rows = [
        ("literal", -1.0, 2, 1e-2, 1.0, False, True),
        ("fast", -1.0, 2, 1e-2, 0.2, False, False),
        ("fast", 1e-2, 2, 5e-3, 0.05, True, False),
        ("fast", 1e-9, 2, np.nan, np.nan, False, False),
        ("fast", -1.0, 1, 1e-2, 0.4, True, False),
    ]
    method, rtol, threads, error, seconds, front, baseline = zip(*rows, strict=True)
    columns = {"error": error, "seconds": seconds, "front": front, "baseline": baseline}
    return xr.Dataset(
        {name: ("run", np.array(values)) for name, values in columns.items()},
        {
            "method": ("run", list(method)),
            "rtol": ("run", list(rtol)),
            "threads": ("run", list(threads)),
        },
        {"title": "a scene"},
    )


def test_tolerances_are_a_family_of_their_own(table):
    assert families(table) == ["literal", "fast", "fast, rtol", "fast, rtol", "fast"]


def test_runs_on_a_gpu_are_too(table):
    device = ["cpu", "cpu", "gpu", "gpu", "gpu"]
    swept = table.assign_coords(device=("run", device))
    names = ["literal", "fast", "fast, rtol, gpu", "fast, rtol, gpu", "fast, gpu"]
    assert families(swept) == names
    single = table.assign_coords(device="gpu", precision="single")
    assert families(single)[1:3] == ["fast, single, gpu", "fast, rtol, single, gpu"]
    labels = [text.get_text() for text in draw_front([swept]).legends[0].get_texts()]
    assert labels[:3] == ["literal", "fast", "fast, rtol, gpu"]


def test_the_figure_marks_front_and_baseline_on_all_threads(table):
    figure = draw_front([table, table, table])
    ax = figure.axes[0]
    assert ax.get_title() == "a scene" and ax.get_xscale() == ax.get_yscale() == "log"
    lines = [list(zip(*line.get_data(), strict=True)) for line in ax.lines]
    assert [(5e-3, 0.05)] in lines and [(1e-2, 0.2)] in lines
    assert not any((1e-2, 0.4) in line for line in lines)
    assert "20×" in [text.get_text() for text in ax.texts]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:3] == ["literal", "fast", "fast, rtol"]


def test_a_table_without_errors_has_no_front(table):
    with pytest.raises(ValueError, match="a scene: has no errors"):
        draw_front([table.drop_vars("front")])
