"""Words of a study file that the analysis knows."""

from granstudy.analysis.figures.figure import FIGURES
from granstudy.analysis.tables.fits import FITS
from granstudy.analysis.vocabulary import SCHEMA, study_schema, write_schema


def test_editors_know_the_words(tmp_path):
    sections = study_schema()["$defs"]
    assert sections["FigureModel"]["properties"]["kind"]["enum"] == list(FIGURES)
    assert sections["FitModel"]["properties"]["law"]["enum"] == list(FITS)
    write_schema(tmp_path / "study.schema.json")
    committed = SCHEMA
    assert (tmp_path / "study.schema.json").read_text() == committed.read_text()
