"""The report of a study: one page of HTML that holds all that it shows."""

from pathlib import Path
from typing import Any

from granstudy.analysis.report.citation import citations
from granstudy.analysis.report.facts import LABELS, Counts, computed_by, run_facts
from granstudy.analysis.report.frames import frames
from granstudy.analysis.report.sections import sections
from granstudy.datasets.run_dataset import versions
from granstudy.study.layout import Layout
from granstudy.support.files import write_text

VERSION = versions()["granstudy"]
"""Of granstudy, which makes the page."""


def write_report(
    layout: Layout, study_file: str | Path, target: str | Path, tables: str | Path | None = None
) -> None:
    """Write the report of a study, whole or not at all.

    What was not made, such as a table that failed, is named as missing. The page depends on the study's
    results alone: the same results give the same bytes. Run times and dates stand beside the runs in the
    store, and are those of whoever computed them.

    Parameters
    ----------
    study_file : str or Path
        The study file, which the page shows whole.
    target : str or Path
    tables : str or Path, optional
        Folder that gets a page for each table, for Snakemake's own report.
    """
    found, known = sections(layout), frames()
    if tables is not None:
        alone = known.get_template("alone.html.j2")
        for section in found:
            page = alone.render(section=section, version=VERSION)
            write_text(Path(tables) / f"{section.name}.html", page)
    facts = _facts(layout, Path(study_file))
    write_text(Path(target), known.get_template("page.html.j2").render(sections=found, **facts))


def _facts(layout: Layout, study_file: Path) -> dict[str, Any]:
    """What the page says beside tables and figures."""
    names = list(layout.study.model.experiments)
    facts = {name: run_facts(layout, name) for name in names}
    runs = [run for found in facts.values() for run in found]
    libraries, commits = computed_by(layout, names)
    written = sorted(run.written[:10] for run in runs if run.written)
    return {
        "study": layout.study,
        "title": layout.study.model.title,
        "labels": LABELS,
        "counts": [Counts.of(name, found) for name, found in facts.items()],
        "whole": Counts.of("all", runs),
        "runs": runs,
        "early": [run for run in runs if run.status != "ok"],
        "doubtful": [run for run in runs if run.label in ("marginal", "untrusted")],
        "computed": list(dict.fromkeys([*written[:1], *written[-1:]])),
        "versions": libraries,
        "commits": commits,
        "version": VERSION,
        "citations": citations(),
        "file_name": study_file.name,
        "file_text": study_file.read_text(encoding="utf-8"),
    }
