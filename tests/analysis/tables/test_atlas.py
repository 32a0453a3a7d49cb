"""The atlas of a study: states to an accuracy over e and λ, in one dataset and one figure."""

import numpy as np
import pytest
from studies import load_text

import granstudy as gs
from granstudy import theory
from granstudy.analysis.figures.atlas import ROWS, draw_atlas
from granstudy.analysis.requests import check_requests
from granstudy.analysis.tables.atlas import (
    AXES,
    LEAST,
    LEAST_OF,
    WITH_ERRORS,
    atlas_of,
    write_atlas,
)
from granstudy.study.layout import Layout
from granstudy.trust.flags import Trust

STUDY = """
title: small atlas
atlas: {title: small}
experiments:
  cooling:
    title: cooling
    run: state
    state: cooling
    scene: {name: maxwellian3d, diffusion: 0.0}
    accuracy: 1.0e-2
    sweep: &gases
      - {e: [0.2, 0.9], exponent: [0.0, 0.5, 1.0]}
  heated:
    title: heated
    run: state
    state: heated
    scene: {name: maxwellian3d, diffusion: 0.1}
    accuracy: 1.0e-2
    sweep: *gases
"""


@pytest.fixture(scope="module")
def atlas(made):
    return atlas_of("small", [made.tables["cooling"], made.tables["heated"]])


def test_an_atlas_has_every_state_with_its_errors(atlas):
    assert dict(atlas.sizes) == {"state": 2, "dim": 1, "exponent": 3, "e": 2}
    scene = gs.load_scene("maxwellian3d", e=0.9, exponent=0.5, diffusion=0.0)
    state = gs.cooling_state(scene, accuracy=1e-2, progress=False)
    one = atlas.sel(state="cooling", dim=3, exponent=0.5, e=0.9)
    for name in WITH_ERRORS:
        assert atlas[name].dims == AXES
        assert float(one[name]) == float(state[name])
        own = float(state[f"{name}_error"])
        least = LEAST * float(one[name]) if LEAST_OF.get(name) else LEAST
        assert float(one[f"{name}_error"]) == (max(own, least) if name in LEAST_OF else own)
        assert atlas[name].attrs["ancillary_variables"] == f"{name}_error"
        assert {"long_name", "units"} <= set(atlas[name].attrs)
    assert float(one["a2_linear"]) == theory.cooling_state_a2(0.9, 3, 0.5)
    assert float(atlas["strength"].sel(dim=3)) == pytest.approx(1 / (4 * np.pi))
    assert float(atlas["accuracy"]) == 1e-2
    assert bool(np.all(atlas["trust"] == Trust.TRUSTED))
    assert bool(atlas["a2_divided"].sel(state="heated").isnull().all())


def test_exact_numbers_keep_their_errors(atlas):
    exact = atlas.sel(exponent=0.0)
    assert float(exact["a2_error"].max()) < 1e-11
    assert float(atlas["a2_error"].sel(exponent=[0.5, 1.0]).min()) >= LEAST


def test_linear_theory_of_K_is_that_of_a_gaussian_but_for_a2(atlas):
    """The theories are exact for Maxwell molecules, and off by less than 2 % elsewhere."""
    ratio = atlas["cooling_coefficient_linear"] / atlas["cooling_coefficient"]
    np.testing.assert_allclose(ratio.sel(exponent=0.0), 1.0, rtol=1e-12)
    assert 1e-5 < float(abs(ratio - 1.0).max()) < 2e-2


def test_it_is_written_in_three_forms(atlas, tmp_path):
    files = [tmp_path / f"atlas.{form}" for form in ("nc", "csv", "md")]
    write_atlas(atlas, *files)
    assert gs.read_dataset(files[0]).equals(atlas)
    lines = files[1].read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + 12 and lines[0].startswith("state,dim,exponent,e,a2,a2_error")
    text = files[2].read_text(encoding="utf-8")
    assert "| cooling" in text and "e = 1 has neither state" in text and "not trusted:" not in text
    worse = atlas.copy(deep=True)
    worse["trust"][0, 0, 1, 0] = Trust.MARGINAL
    write_atlas(worse, *files)
    assert "- cooling, 3D, λ = 0.5, e = 0.2: marginal, a2 = " in files[2].read_text(
        encoding="utf-8"
    )


def test_its_figure_has_a_map_for_each_state_and_number(atlas):
    figure = draw_atlas(atlas)
    maps = [ax for ax in figure.axes if ax.images]
    assert len(maps) == 2 * len(ROWS)
    drawn = maps[0].images[0].get_array()
    np.testing.assert_array_equal(drawn, atlas["a2"].sel(state="cooling", dim=3))
    assert not figure.legends
    worse = atlas.copy(deep=True)
    worse["trust"][0, 0, 1, 0] = Trust.UNTRUSTED
    (legend,) = draw_atlas(worse).legends
    assert [text.get_text() for text in legend.get_texts()] == ["untrusted"]


def test_a_study_asks_for_its_atlas(made):
    layout = Layout(made.study, "made")
    assert layout.tabled == ["atlas"]
    files = ["made/test/tables/atlas.nc", "made/test/figures/atlas.png"]
    assert layout.atlas == files and set(files) <= set(layout.wanted)
    assert layout.atlas_tables == ["made/test/tables/cooling.nc", "made/test/tables/heated.nc"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "    accuracy: 1.0e-2\n",
            "    solver: {N: 24, R: 9.0, method: radial}\n",
            "there is none",
        ),
        ("exponent: [0.0, 0.5, 1.0]", "temperature: [1.0]", "sweeps e, temperature; states of an"),
        ("    sweep: *gases", "    sweep: [{e: 0.9, exponent: 1.0}]", "the same values of e and"),
        (
            "    state: heated\n    scene: {name: maxwellian3d, diffusion: 0.1}",
            "    state: cooling\n    scene: {name: maxwellian3d, diffusion: 0.0}",
            "two experiments have the cooling state in 3D",
        ),
        (
            "maxwellian3d, diffusion: 0.1",
            "maxwellian2d, diffusion: 0.1",
            "cooling 2D, heated 3D is",
        ),
        ("  heated:", "  atlas:", "is taken"),
        ("atlas: {title: small}", "atlas: {title: $\\x$}", "atlas.title"),
    ],
)
def test_what_makes_no_atlas_is_said_before_any_run(old, new, message, tmp_path):
    assert old in STUDY
    with pytest.raises(ValueError, match=message):
        check_requests(load_text(tmp_path, STUDY.replace(old, new)))
