"""Tables that are planned have the columns of those that are made; what runs are said to have, they have."""

import planted_mistakes
import pytest

from granstudy.analysis.figures.figure import check_figure
from granstudy.analysis.requests import table_source
from granstudy.analysis.source import FigureSource
from granstudy.analysis.tables.planned import HAVE, planned_table
from granstudy.datasets.open_runs import final_values

TIMED = ("timed", "front")
"""Benchmarks, which are no runs of their own."""

STUDY = "".join(
    section
    for section in planted_mistakes.sections(planted_mistakes.STUDY)
    if section.split(":")[0].strip() not in TIMED
)
NAMES = ("cooling", "order", "printed", "held", "long", "particles", "errors", "states")


@pytest.mark.parametrize("name", NAMES)
def test_a_planned_table_has_the_columns_of_the_real_one(made, name):
    real = made.tables[name]
    beside = [made.tables[other] for other in made.experiment(name).beside_table]
    source = table_source(made.study, name, beside)
    planned = planned_table(source)
    fitted = {"C0_error", "C0_theory", "order", "slope", "slope_error", "seconds"}
    assert set(planned.data_vars) ^ set(real.data_vars) <= fitted
    assert planned.attrs["swept"] == real.attrs["swept"]
    assert set(planned.coords) - {"run"} == set(real.coords) - {"run", "time"}
    if made.experiment(name).figure is not None:
        figure = FigureSource(
            experiment=source.experiment, runs=source.runs, files=source.files, table=planned
        )
        check_figure(figure)


@pytest.mark.parametrize("name", ["cooling", "order", "long", "particles"])
def test_runs_have_what_they_are_said_to_have(made, name):
    runs = made.study.runs[name].values()
    for run, file in zip(runs, made.files[name], strict=True):
        last = final_values([file])
        real = {str(key) for key, v in last.data_vars.items() if v.dims == ("run",)}
        assert {key for key, (_, has) in HAVE.items() if has(run)} == real & HAVE.keys()
