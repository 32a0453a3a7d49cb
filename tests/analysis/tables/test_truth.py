"""Runs held against a truth: from the study file over tables and figures to the map of labels."""

import numpy as np
import pytest
import xarray as xr
from studies import replaced

import granstudy as gs
from granstudy import theory
from granstudy.analysis.figures.figure import save_figure
from granstudy.analysis.tables.map import label_map, write_map
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.table import write_table
from granstudy.trust.flags import Status, Trust
from granstudy.trust.truth import maxwell_truth

STUDY = """
title: tiny
map: {title: labels}
experiments:
  law:
    title: an exact law
    run: evolution
    scene: {name: bkw2d, restitution: 0.5, diffusion: 0.1}
    solver: {method: radial}
    time: {t_final: 2.0, time_rtol: 1.0e-7, times: [0.5, 1.0], frame: fixed, save_every: 9}
    truth: {law: maxwell}
    sweep:
      - {diffusion: [0.1, 0.2], N: [8, 24], R: [9.0]}
    table: {quantity: largest_a2_error}
    figure: {kind: gallery}
  run:
    title: another run
    run: evolution
    scene: {name: maxwellian2d, restitution: 0.5, exponent: 1.0, diffusion: 0.0}
    solver: {method: radial, R: 9.0, N: 24}
    time: {t_final: 2.0, frame: fixed, save_every: 9}
    truth:
      solver: {method: radial, R: 10.0, N: 28}
      time: {time_rtol: 1.0e-9, times: [0.5, 1.0], frame: rescaled}
    sweep:
      - {e: [0.4, 0.8], dt: [0.1, 0.5]}
    table: {quantity: largest_temperature_error}
    figure: {kind: gallery}
"""


def test_a_truth_is_computed_once_for_each_gas(made):
    study = made.study
    assert "reference" not in "".join(study.runs["law"])
    paths = list(study.runs["run"])
    assert [path for path in paths if path.startswith("reference")] == [
        "reference/e~0.4",
        "reference/e~0.8",
    ]
    truth = study.run("run", "reference/e~0.8")
    assert truth.is_reference and truth.time_fields == {
        "t_final": 2.0,
        "time_rtol": 1e-9,
        "times": [0.5, 1.0],
        "frame": "rescaled",
        "save_every": 9,
    }
    assert (truth.scene.restitution, truth.solver.N, truth.solver.R) == (0.8, 28, 10.0)
    assert (
        study.run("run", "e~0.8/dt~0.1").truth.computation.parameters
        == truth.computation.parameters
    )


def test_the_law_starts_from_the_density_not_from_the_grid(made):
    table, files = made.tables["law"], made.files["law"]
    run = made.study.run("law", "diffusion~0.1/N~8/R~9")
    ds = gs.read_dataset(files[0])
    T = theory.maxwell_temperature(ds["time"].values, 1.0, 0.5, 0.1)
    expected = np.max(np.abs(ds["temperature"].values / T - 1.0))
    assert float(table["largest_temperature_error"][0]) == pytest.approx(expected, rel=1e-12)
    # eight nodes sample the density badly, which the discrete law does not see and the estimate does
    assert expected > 1e-3 > 1e-6 > float(table["largest_temperature_error"][1])
    assert float(ds["temperature_error_estimate"][0]) >= abs(float(ds["temperature"][0]) - 1.0)
    a2 = maxwell_truth(run.scene, np.array([0.0])).a2
    assert a2 == pytest.approx([run.scene.moments.a2])


def test_errors_are_the_largest_at_common_times(made):
    table, files = made.tables["run"], made.files["run"]
    by_path = {file.split("/run/")[1]: gs.read_dataset(file) for file in files}
    ds, truth = by_path["e~0.4/dt~0.5.nc"], by_path["reference/e~0.4.nc"]
    at = [0.0, 0.5, 1.0, 2.0]
    ours, exact = ds.sel(time=at), truth.sel(time=at)
    row = table.isel(run=1)
    assert (float(row["e"]), float(row["dt"])) == (0.4, 0.5)
    for name, scale in (("temperature", exact["temperature"]), ("a2", 1.0)):
        expected = float(np.max(np.abs((ours[name] - exact[name]) / scale)))
        assert float(row[f"largest_{name}_error"]) == pytest.approx(expected, rel=1e-9)
    # the step's error, at third order, above the truth's own
    smaller = table.isel(run=0)["largest_temperature_error"]
    assert 30 < float(row["largest_temperature_error"] / smaller) < 300
    assert "radial, N = 28, R = 10, trusted (T known to" in table.attrs["truth"]


def test_tables_figures_and_the_map_are_written(made, tmp_path):
    for name, table in made.tables.items():
        stem = tmp_path / name
        write_table(table, *(stem.with_suffix(s) for s in (".nc", ".csv", ".md")))
        figure = made.draw(name)
        save_figure(figure, stem.with_suffix(".png"), stem.with_suffix(".svg"))
        T, a2, density = figure.axes
        # every run and every truth in each panel, and minus the density where it is negative
        truths = 2  # one for each gas
        assert len(T.lines) == len(a2.lines) == table.sizes["run"] + truths
        assert len(density.lines) == 2 * (table.sizes["run"] + (truths if name == "run" else 0))
        labels = [text.get_text() for text in figure.legends[0].get_texts()]
        words = [Trust(int(label)).name.lower() for label in table["trust"]]
        assert [label.split(": ")[1] for label in labels if "truth" not in label] == words
    found = label_map("labels", made.tables)
    write_map(found, *(tmp_path / f"map.{s}" for s in ("nc", "csv", "md")))
    assert xr.open_dataset(tmp_path / "map.nc").sizes["run"] == 8
    lines = (tmp_path / "map.csv").read_text().splitlines()
    assert lines[0].startswith("case,configuration,variation,largest_temperature_error,")
    assert (
        lines[1].startswith('law,"radial, fixed","N = 8, R = 9, diffusion = 0.1",')
        and len(lines) == 9
    )
    assert "0 of 8 labels break the rule" in (tmp_path / "map.md").read_text()
    assert lines[1].endswith("untrusted,ok,False")


def test_a_front_of_runs_shows_both_errors_over_their_seconds(made):
    asked = made.experiment("law")
    timed = asked.model_copy(
        update={
            "table": asked.table.model_copy(update={"seconds": True}),
            "figure": asked.figure.model_copy(update={"kind": "front"}),
        }
    )
    assert "seconds" not in made.tables["law"]
    table = made.table("law", timed)
    figure = made.draw("law", timed, table)
    for ax, measure in zip(
        figure.axes, ("largest_temperature_error", "largest_a2_error"), strict=True
    ):
        marks = [line for line in ax.lines if line.get_linestyle() == "None"]
        points = [xy for line in marks for xy in zip(*line.get_data(), strict=True)]
        expected = zip(table["seconds"].values, table[measure].values, strict=True)
        assert sorted(points) == sorted(expected)
    with pytest.raises(ValueError, match="a front needs table.seconds: true"):
        made.draw("law", timed)


def test_a_run_that_failed_before_its_first_output_has_no_errors(tabulated):
    """A tolerance that the grid cannot keep: the other runs have their rows all the same."""
    law = STUDY[STUDY.index("  law:") : STUDY.index("  run:\n")]
    head = "title: tiny\nexperiments:\n"
    block = "      - {diffusion: 0.1, N: 8, R: 9.0, method: fast, rtol: 1.0e-9}\n    table:"
    table = tabulated(head + replaced(law, "    table:", block)).tables["law"]
    assert [Status(int(status)) for status in table["status"]] == [Status.OK] * 4 + [Status.FAILED]
    for name in ("largest_temperature_error", "a2_error_estimate", "temperature"):
        np.testing.assert_array_equal(np.isnan(table[name]), [False] * 4 + [True])
    assert table.attrs["truth"] == "exact law"
    rows = [line for line in markdown_table(table).splitlines() if line.endswith(" failed |")]
    assert len(rows) == 1 and "nan" not in rows[0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("truth: {law: maxwell}", "truth: {law: haff}", "experiments.law.truth.law: .*'maxwell'"),
        ("truth: {law: maxwell}", "truth: {}", "law, solver: give one"),
        (
            "truth: {law: maxwell}",
            "truth: {law: maxwell, time: {dt: 0.1}}",
            "law: takes no scene and no time",
        ),
        (
            "diffusion: 0.1}",
            "exponent: 1.0}",
            "truth.law='maxwell': holds at exponent 0, not at 1.0",
        ),
        ("restitution: 0.5", "restitution: {viscoelastic: 0.1}", "constant e"),
        ("R: 10.0, N: 28", "R: 10.0, N: 2", "truth: N=2: must be an integer of at least 4"),
        ("  law:\n", "  map:\n", "experiments.'map': is taken"),
        (
            "    truth: {law: maxwell}\n    sweep:\n      - {diffusion: [0.1, 0.2], N: [8, 24], R: [9.0]}\n"
            "    table: {quantity: largest_a2_error}\n    figure: {kind: gallery}",
            "    sweep:\n      - {N: [24], R: [9.0]}\n    table: {quantity: a2, seconds: true}",
            "table.seconds: stands beside errors of runs with a truth; give one",
        ),
    ],
)
def test_what_does_not_fit_is_refused(load, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(old, new)
