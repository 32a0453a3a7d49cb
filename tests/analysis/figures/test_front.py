"""The front of speed against error as a figure."""

import pytest

from granstudy.analysis.figures.front import benchmark_front


def test_the_figure_marks_front_and_baseline_on_all_threads(front):
    figure = benchmark_front([front, front, front])
    ax = figure.axes[0]
    assert ax.get_title() == "a scene" and ax.get_xscale() == ax.get_yscale() == "log"
    lines = [list(zip(*line.get_data(), strict=True)) for line in ax.lines]
    assert [(5e-3, 0.05)] in lines and [(1e-2, 0.2)] in lines
    assert not any((1e-2, 0.4) in line for line in lines)
    assert "20×" in [text.get_text() for text in ax.texts]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:3] == ["literal", "fast", "fast, rtol"]


def test_a_table_without_errors_has_no_front(front):
    with pytest.raises(ValueError, match="a scene: has no errors"):
        benchmark_front([front.drop_vars("front")])


def test_runs_on_a_gpu_have_lines_of_their_own(front):
    swept = front.assign_coords(device=("run", ["cpu", "cpu", "gpu", "gpu", "gpu"]))
    labels = [text.get_text() for text in benchmark_front([swept]).legends[0].get_texts()]
    assert labels[:3] == ["literal", "fast", "fast, rtol, gpu"]
