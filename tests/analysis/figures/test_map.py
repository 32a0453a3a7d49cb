"""The map as a figure: where its runs lie, and their colours."""

import numpy as np
import xarray as xr
from matplotlib.colors import to_rgba

from granstudy.analysis.figures.map import LABEL_COLOURS, draw_map


def map_of(rows):
    """A map of rows (case, configuration, trust, error of T)."""
    cases, configurations, trusts, T = zip(*rows, strict=True)
    measures = dict.fromkeys(
        ("temperature_error_estimate", "largest_a2_error", "a2_error_estimate")
    )
    columns = {name: ("run", np.zeros(len(rows))) for name in measures}
    columns |= {"largest_temperature_error": ("run", np.array(T))}
    columns |= {"trust": ("run", np.array(trusts)), "status": ("run", np.zeros(len(rows), int))}
    columns["wrong"] = (
        "run",
        np.array([t == 2 and T > 1e-2 for t, T in zip(trusts, T, strict=True)]),
    )
    text = {"case": cases, "configuration": configurations, "variation": ["N = 8"] * len(rows)}
    return xr.Dataset(
        columns, {k: ("run", np.array(v, object)) for k, v in text.items()}, {"title": "labels"}
    )


def test_the_map_has_a_cell_for_each_run_coloured_by_its_label():
    rows = [
        ("cold", "fast, fixed", 0, 0.3),
        ("cold", "fast, fixed", 2, 0.02),
        ("cold", "radial, rescaled", 2, 1e-9),
        ("hot", "radial, rescaled", 1, 1e-3),
    ]
    (ax,) = draw_map(map_of(rows)).axes
    places = [(p.get_x(), p.get_y(), p.get_height()) for p in ax.patches]
    assert places == [(0, 0, 1), (0, 1, 1), (1, 0, 2), (1, 2, 1)]
    words = ("untrusted", "trusted", "trusted", "marginal")
    for patch, word in zip(ax.patches, words, strict=True):
        assert patch.get_facecolor() == to_rgba(LABEL_COLOURS[word])
    assert [text.get_text() for text in ax.texts][1] == "N = 8:  2e-02 | 0e+00"
    # the wrong label is framed
    assert [patch.get_linewidth() for patch in ax.patches] == [0.8, 2.0, 0.8, 0.8]
