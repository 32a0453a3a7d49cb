"""Tables of a tiny study, computed from real runs."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.analysis.figures.figure import save_figure
from granstudy.analysis.tables.runs import collision_table
from granstudy.analysis.tables.table import KINDS, Kind, write_table
from granstudy.study.schema.experiment import EvolutionExperiment

STUDY = """
title: tiny
experiments:
  table1:
    title: convergence
    run: evolution
    scene: {name: bkw2d}
    solver: {R: 7.8, N_rho: 30, M_cir: 30}
    time: {t_final: 2.0, dt: 0.1}
    sweep:
      - {e: [0.2, 0.8], N: [8, 16], variant: [full], method: [literal, fast]}
    table: {quantity: paper_temperature_error, paper: table1}
    figure: {kind: convergence, x: N}
  order:
    title: order
    run: evolution
    scene: {name: bkw2d, restitution: 0.2}
    solver: {R: 7.8, N_rho: 16, M_cir: 16, N: 64, method: fast}
    time: {t_final: 2.0}
    sweep:
      - {dt: [0.5, 0.25, 0.125]}
    table: {quantity: paper_temperature_error}
    fit: {law: order, x: dt}
    figure: {kind: convergence, x: dt}
  errors:
    title: errors
    run: collision
    scene: {name: bkw2d, restitution: 0.2}
    solver: {R: 7.8, N: 16, N_rho: 16, method: literal}
    reference: {method: direct, circular: true}
    sweep:
      - {M_cir: [4, 8]}
    table: {quantity: collision_error}
    figure: {kind: convergence, x: M_cir}
"""


def test_ours_stands_beside_the_printed_number(made):
    table = made.tables["table1"]
    assert table.sizes == {"run": 8}
    literal = table.isel(run=(table["method"] == "literal").values)
    # dt = 0.1 instead of 0.01 shows in the digits only where the error is small
    np.testing.assert_allclose(literal["ratio"], 1.0, atol=1e-4)
    np.testing.assert_allclose(literal["paper"][0], 9.21116565e-01)


def test_the_order_is_three(made):
    table = made.tables["order"]
    np.testing.assert_allclose(table["order"], 3.0, atol=0.1)


def test_collision_errors_are_measured_against_the_reference(made):
    table, files = made.tables["errors"], made.files["errors"]
    assert list(table["M_cir"].values) == [4, 8]
    by_path = {file.split("/errors/")[1]: gs.read_dataset(file)["Q"].values for file in files}
    expected = np.max(np.abs(by_path["M_cir~4.nc"] - by_path["reference.nc"]))
    assert float(table["collision_error"][0]) == expected
    assert table["collision_error"][1] < table["collision_error"][0]


def test_tables_and_figures_are_written_and_the_same_each_time(made, tmp_path):
    for name, table in made.tables.items():
        for copy in ("a", "b"):
            stem = tmp_path / copy / name
            write_table(table, *(stem.with_suffix(s) for s in (".nc", ".csv", ".md")))
            save_figure(made.draw(name), stem.with_suffix(".png"), stem.with_suffix(".svg"))
    names = sorted(p.name for p in (tmp_path / "a").iterdir())
    assert len(names) == 5 * len(made.tables)
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_runs_open_as_one_array_over_the_swept_parameters(made):
    folder = made.folder
    over = ("e", "N", "method")
    one = gs.read_dataset(folder / "runs/table1/e~0.2/N~16/variant~full/method~fast.nc")
    with gs.final_values(folder / "runs/table1") as final:
        temperature = gs.unstack_runs(final, over)["temperature"].compute()
    assert dict(temperature.sizes) == {"e": 2, "N": 2, "method": 2}
    chosen = temperature.sel({"e": 0.2, "N": 16, "method": "fast"})
    assert float(chosen) == float(one["temperature"][-1])
    with gs.final_values(sorted((folder / "runs/table1").rglob("*.nc"))[:-1]) as partial:
        holes = gs.unstack_runs(partial, over)["status"].compute()
    assert int((holes == -1).sum()) == 1


def test_a_column_that_nobody_listed_is_an_error_that_names_it(made, monkeypatch):
    def with_more(source):
        return collision_table(source).assign(surprise=("run", [1.0, 2.0]))

    monkeypatch.setitem(KINDS, "collision", Kind(with_more, "collision_error"))
    with pytest.raises(ValueError, match="column 'surprise': has no row in"):
        made.table("errors")


@pytest.mark.parametrize(
    ("table", "fit", "message"),
    [
        (
            {"quantity": "temperture"},
            None,
            "unknown quantity 'temperture' .did you mean 'temperature'",
        ),
        (
            {"quantity": "a2", "paper": "figure4"},
            None,
            "paper='figure4': prints C0, which the table",
        ),
        (
            {"quantity": "a2"},
            {"law": "order", "x": "N"},
            "fit.x='N': must be one of the swept parameters dt",
        ),
    ],
)
def test_what_the_runs_do_not_fit_is_refused(made, table, fit, message):
    model = made.experiment("order").model_dump(exclude_unset=True) | {"table": table, "fit": fit}
    with pytest.raises(ValueError, match=message):
        made.table("order", EvolutionExperiment.model_validate(model))
