"""Lines and maps show all numbers, their labels, and their trust, and legends stand off the axes."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex

from granstudy.analysis.figures.plots.marks import PALE
from granstudy.analysis.figures.plots.quantity import lines_figure, map_figure
from granstudy.analysis.figures.plots.scales import number_scale
from granstudy.analysis.figures.plots.series import series_of
from granstudy.trust.flags import Trust

T = np.geomspace(0.01, 100.0, 9)


def data(e, N=(16,), name="a2", value=lambda t, e, N: (0.6 - e) * t / (1 + t)):
    """A quantity over (e, N, time)."""
    values = [[value(T, one, n) for n in N] for one in e]
    coords = {
        "e": ("e", list(e), {"long_name": "restitution coefficient", "units": "1"}),
        "N": list(N),
        "time": ("time", T, {"units": "s"}),
    }
    y = xr.DataArray(np.array(values), coords, ("e", "N", "time"), name)
    return y.assign_attrs(long_name="kurtosis excess", units="1", symbol="$a_2$")


def trusts(e, N=(16,), **labels):
    """Labels over (e, N), trusted but where they are given as ``e<i>``."""
    found = xr.DataArray(np.full((len(e), len(N)), 2, np.int8), dims=("e", "N"))
    for key, label in labels.items():
        found[int(key[1:])] = int(label)
    return found


def texts(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def markers(ax):
    """Lines that are markers alone."""
    return [line for line in ax.lines if line.get_linestyle() == "None"]


def curves(ax):
    return [
        line for line in ax.lines if line.get_linestyle() != "None" and len(line.get_xdata()) > 2
    ]


def test_few_lines_have_a_legend_below_and_signed_numbers_a_linear_axis():
    figure = lines_figure(data((0.5, 0.7, 0.9)), "time")
    (ax,) = figure.axes
    assert texts(figure) == ["$e$ = 0.5", "$e$ = 0.7", "$e$ = 0.9"]
    assert ax.get_legend() is None
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$t$ (s)", "$a_2$")
    assert figure.get_suptitle() == "kurtosis excess"
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "linear")
    shown = np.concatenate([line.get_ydata() for line in curves(ax)])
    assert shown.min() < -0.2 and shown.size == 27, "negative numbers are not drawn"
    low, high = ax.get_ylim()
    assert low < shown.min() and high > shown.max()
    assert all(to_hex(m.get_markerfacecolor()) == to_hex(m.get_color()) for m in markers(ax))


def test_a_legend_covers_no_curve():
    figure = lines_figure(data((0.5, 0.7, 0.9), (8, 16, 24)), "time")
    FigureCanvasAgg(figure).draw()
    (legend,) = figure.legends
    (ax,) = figure.axes
    assert not legend.get_window_extent().overlaps(ax.get_window_extent())


def test_many_numbers_have_a_colour_bar_and_no_legend():
    figure = lines_figure(data(np.linspace(0.1, 0.95, 12)), "time")
    ax, bar = figure.axes
    assert texts(figure) == [] and bar.get_ylabel() == "$e$"
    assert len({to_hex(line.get_color()) for line in curves(ax)}) == 12


def test_two_parameters_are_colour_and_style():
    figure = lines_figure(data((0.5, 0.7, 0.9), (8, 16)), "time")
    lines = curves(figure.axes[0])
    assert len(lines) == 6
    assert len({(to_hex(line.get_color()), line.get_linestyle()) for line in lines}) == 6
    assert len({to_hex(line.get_color()) for line in lines}) == 3
    assert texts(figure) == ["$e$ = 0.5", "$e$ = 0.7", "$e$ = 0.9", "$N$ = 8", "$N$ = 16"]


def test_runs_that_are_not_trusted_are_hollow_and_pale_with_a_legend():
    e = (0.5, 0.7, 0.9)
    labels = trusts(e, e0=Trust.UNTRUSTED, e1=Trust.MARGINAL)
    figure = lines_figure(data(e), "time", labels)
    (ax,) = figure.axes
    assert texts(figure)[-2:] == ["marginal", "untrusted"]
    pale, hollow, filled = markers(ax)
    assert pale.get_markerfacecolor() == hollow.get_markerfacecolor() == "white"
    assert (pale.get_alpha(), hollow.get_alpha()) == (PALE, None)
    assert filled.get_markerfacecolor() == filled.get_color()
    assert [line.get_alpha() for line in curves(ax)] == [PALE, 1.0, 1.0]


def test_over_a_parameter_each_point_has_its_label():
    e = (0.5, 0.7, 0.9)
    y = data(e).isel(time=-1, N=0)
    figure = lines_figure(y, "e", trusts(e, e2=Trust.UNTRUSTED).isel(N=0))
    (ax,) = figure.axes
    found = {tuple(m.get_xdata()): m.get_markerfacecolor() for m in markers(ax)}
    assert found[0.9,] == "white" and found[0.5, 0.7] != "white"
    assert ax.get_xlabel() == "$e$" and texts(figure) == ["untrusted"]


def test_an_untrusted_outlier_does_not_flatten_the_others():
    y = data((0.5, 0.7)).copy()
    y[1, 0, -1] = -1300.0
    labels = trusts((0.5, 0.7), e1=Trust.UNTRUSTED)
    (ax,) = lines_figure(y, "time", labels).axes
    assert ax.get_yscale() == "symlog"
    assert ax.yaxis.get_transform().linthresh == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ([1.0, 2.0, 5.0], "linear"),
        ([1e-3, 1.0], "log"),
        ([-1.0, 2.0, 0.5], "linear"),
        ([-1e-3, 1e-3, 2e-3, 50.0], "symlog"),
        ([0.0, 0.0], "linear"),
        ([np.nan, 1.0], "linear"),
    ],
)
def test_the_scale_shows_all_numbers(values, scale):
    assert number_scale([np.array(values)]) == scale


def test_a_scale_can_be_asked_for():
    (ax,) = lines_figure(data((0.5,)), "time", xscale="linear", yscale="symlog").axes
    assert (ax.get_xscale(), ax.get_yscale()) == ("linear", "symlog")
    with pytest.raises(ValueError, match="yscale='cubic': allowed are linear, log, symlog"):
        lines_figure(data((0.5,)), "time", yscale="cubic")


def test_refined_parameters_lie_in_equal_steps_with_a_tick_each():
    y = data((0.5,), (8, 16, 32)).isel(time=-1)
    (ax,) = lines_figure(y, "N").axes
    assert ax.get_xscale() == "log" and list(ax.get_xticks()) == [8, 16, 32]


def test_words_on_the_abscissa():
    y = xr.DataArray([1.0, 2.0], {"method": ["fast", "radial"]}, ("method",), "temperature")
    (ax,) = lines_figure(y, "method").axes
    assert [t.get_text() for t in ax.get_xticklabels()] == ["fast", "radial"]


def test_runs_with_times_of_their_own():
    y = xr.DataArray(
        [[1.0, 2.0, np.nan], [3.0, 4.0, 5.0]], dims=("run", "output"), name="temperature"
    )
    y = y.assign_coords(time=(("run", "output"), [[0.0, 1.0, np.nan], [0.0, 2.0, 4.0]]))
    one, two = series_of(y, "time")
    assert one.x.tolist() == [0.0, 1.0] and two.y.tolist() == [3.0, 4.0, 5.0]


def test_what_cannot_be_drawn_is_told():
    y = data((0.5, 0.7))
    with pytest.raises(ValueError, match="x='R': must be one of e, N, time"):
        lines_figure(y, "R")
    with pytest.raises(ValueError, match="a2: has no numbers over e"):
        lines_figure(y.where(False), "e")
    with pytest.raises(ValueError, match="has 500 lines over time .*select some"):
        lines_figure(data(np.linspace(0.1, 0.9, 500)), "time")


def test_a_map_has_a_cell_a_number_and_a_hatching_for_each_run():
    e, N = (0.5, 0.7, 0.9), (8, 16)
    labels = trusts(e, N, e0=Trust.UNTRUSTED)
    z = data(e, N).isel(time=-1)
    figure = map_figure(z, "e", "N", labels)
    ax, bar = figure.axes
    assert (ax.get_xlabel(), ax.get_ylabel(), bar.get_ylabel()) == ("$e$", "$N$", "$a_2$")
    assert [t.get_text() for t in ax.get_xticklabels()] == ["0.5", "0.7", "0.9"]
    numbers = {t.get_position(): t.get_text() for t in ax.texts}
    assert numbers[2.5, 0.5] == "-0.3" and len(numbers) == 6
    hatched = {patch.get_xy() for patch in ax.patches}
    assert hatched == {(0, 0), (0, 1)} and texts(figure) == ["untrusted"]
    low, high = ax.collections[0].norm.vmin, ax.collections[0].norm.vmax
    assert low == -high, "0 is not in the middle of the colours of signed numbers"


def test_a_map_has_two_parameters():
    z = data((0.5, 0.7), (8, 16))
    with pytest.raises(ValueError, match="a map has two dimensions; select one value of time"):
        map_figure(z, "e", "N")
    with pytest.raises(ValueError, match="y='R': must be one of e, N"):
        map_figure(z.isel(time=0, drop=True), "e", "R")
    with pytest.raises(ValueError, match="y='e': must be another than x"):
        map_figure(z.isel(time=0), "e", "e")
