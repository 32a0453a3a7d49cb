"""Figures show the table's numbers, ours and the paper's, in the panels they belong to."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.analysis.figures.figure import draw, save_figure
from granstudy.analysis.figures.style import PAPER
from granstudy.study.schema.experiment import BenchmarkExperiment, EvolutionExperiment


def experiment(kind, x=None):
    common = {"title": "a title", "scene": {"name": "bkw2d"}, "sweep": [{"N": [8]}]}
    common["figure"] = {"kind": kind, "x": x}
    if kind == "speed":
        return BenchmarkExperiment(run="benchmark", **common)
    return EvolutionExperiment(run="evolution", time={"t_final": 1.0}, **common)


def drawn(ax):
    """The lines with data of a panel, as sorted lists of points."""
    return [
        sorted((float(x), float(y)) for x, y in zip(*line.get_data(), strict=True) if y == y)
        for line in ax.lines
    ]


@pytest.fixture(scope="session")
def convergence(table_of):
    rows = [
        (0.2, 16, "full", "literal", 1e-2, 1.1e-2),
        (0.2, 32, "full", "literal", 1e-4, 1.1e-4),
        (0.2, 16, "full", "fast", 2e-2, 1.1e-2),
        (0.2, 16, "separate", "fast", 3e-2, np.nan),
        (0.8, 32, "separate", "fast", 4e-5, 5e-5),
        (0.8, 16, "separate", "fast", 4e-3, 5e-3),
        (0.8, 16, "full", "literal", 6e-3, 5e-3),
    ]
    return table_of(rows, ["e", "N", "variant", "method"], "paper_temperature_error")


def test_convergence_has_a_panel_for_each_e_and_variant(convergence):
    figure = draw(experiment("convergence", "N"), convergence, [])
    panels = {ax.get_title(): drawn(ax) for ax in figure.axes}
    assert set(panels) == {
        f"$e$ = {e}, {variant}" for e in (0.2, 0.8) for variant in ("full", "separate")
    }
    first = panels["$e$ = 0.2, full"]
    assert [(16.0, 1e-2), (32.0, 1e-4)] in first
    assert [(16.0, 2e-2)] in first
    assert any((32.0, 1.1e-4) in line for line in first), "the paper's numbers are not drawn"
    # sorted along the abscissa, whatever the order of the rows
    line = next(line for line in figure.axes[3].lines if len(line.get_xdata()) == 2)
    assert list(line.get_xdata()) == [16, 32]


def test_convergence_names_what_it_shows(convergence):
    figure = draw(experiment("convergence", "N"), convergence, [])
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["literal", "fast", PAPER]
    assert figure.get_suptitle() == "a title"
    assert figure.axes[0].get_ylabel() == r"$|T - T_\mathrm{ref}|$"
    assert figure.axes[-1].get_xlabel() == "$N$"
    assert all(ax.get_yscale() == "log" for ax in figure.axes)


def test_a_refined_step_gets_a_guide_of_slope_three(table_of):
    rows = [(dt, 0.3 * dt**3) for dt in (0.1, 0.2, 0.4)]
    table = table_of(rows, ["dt"], "paper_temperature_error")
    table = table.assign_coords(method="fast")
    (ax,) = draw(experiment("convergence", "dt"), table, []).axes
    guide = next(line for line in ax.lines if len(line.get_xdata()) == 2)
    (x0, x1), (y0, y1) = guide.get_data()
    assert np.log(y1 / y0) / np.log(x1 / x0) == pytest.approx(3.0)


def test_an_abscissa_that_is_not_swept_is_refused(convergence):
    with pytest.raises(ValueError, match="figure.x='M_sph': must be one of"):
        draw(experiment("convergence", "M_sph"), convergence, [])


def test_speed_shows_threads_and_the_paper(table_of):
    rows = [
        (8, "direct", 1, 0.01, 0.03),
        (8, "literal", 1, 0.02, 0.02),
        (8, "fast", 1, 0.004, 0.02),
        (8, "fast", 2, 0.003, 0.02),
        (16, "fast", 2, 0.02, 0.14),
        (16, "literal", 1, 0.2, 0.14),
    ]
    (ax,) = draw(
        experiment("speed", "N"), table_of(rows, ["N", "method", "threads"], "seconds"), []
    ).axes
    lines = {line.get_label(): sorted(zip(*line.get_data(), strict=True)) for line in ax.lines}
    assert lines["fast, 1 thread"] == [(8, 0.004)]
    assert lines["fast, 2 threads"] == [(8, 0.003), (16, 0.02)]
    assert lines[f"{PAPER}, direct, 10 cores"] == [(8, 0.03)]
    assert lines[f"{PAPER}, fast, 10 cores"] == [(8, 0.02), (16, 0.14)]


def test_cooling_shows_runs_and_their_fits_with_densities_kept_on_any_grids(table_of, tmp_path):
    files = []
    for e, N in ((0.2, 16), (0.8, 20)):
        scene = gs.load_scene("bkw2d", restitution=e, exponent=1.0)
        solver = gs.Solver(N=N, R=7.8, N_rho=6, M_cir=6, threads=1)
        files.append(tmp_path / f"{e}.nc")
        ds = gs.simulate(scene, solver, t_final=0.5, dt=0.1, save_every=2)
        gs.write_dataset(ds, files[-1])
    table = table_of([(0.2, 0.5), (0.8, 0.7)], ["e"], "temperature")
    table["C0"] = ("run", np.array([0.3, 0.1]))
    left, _ = draw(experiment("cooling"), table, files).axes
    T = gs.open_runs(files, densities=False)["temperature"].values
    np.testing.assert_array_equal(left.lines[0].get_ydata(), T[0])
    np.testing.assert_array_equal(left.lines[2].get_ydata(), T[1])
    t = left.lines[1].get_xdata()
    np.testing.assert_allclose(left.lines[1].get_ydata(), T[0, 0] / (1.0 + 0.3 * t) ** 2)


def test_files_are_whole_and_the_same_each_time(convergence, tmp_path):
    for copy in ("a", "b"):
        figure = draw(experiment("convergence", "N"), convergence, [])
        save_figure(figure, tmp_path / f"{copy}.png", tmp_path / f"{copy}.svg")
    for suffix in ("png", "svg"):
        content = (tmp_path / f"a.{suffix}").read_bytes()
        assert content == (tmp_path / f"b.{suffix}").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "a.svg", "b.png", "b.svg"]
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert b"<dc:date>" not in (tmp_path / "a.svg").read_bytes()
