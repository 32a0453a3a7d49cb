"""Take results into `docs/results`, which is committed: ``python docs/refresh_results.py quick``.

Studies write into `results`, where git does not look. This command copies tables and figures of a shipped
study from there, and removes those that the study no longer has. It says how far each new table is from the
committed one, as ``python -m granstudy.analysis.compare`` does.
"""

import shutil
from pathlib import Path

import click

from granstudy.analysis.compare import Grade, compare_folders
from granstudy.study.layout import Layout
from granstudy.study.study import load_study

REPOSITORY = Path(__file__).parents[1]

COMMITTED = REPOSITORY / "docs" / "results"
"""Tables and figures of the shipped studies, a folder each."""

STUDIES = REPOSITORY / "studies"
"""The shipped studies."""

FORMS = {"tables": ("nc", "csv", "md"), "figures": ("png", "svg")}
"""Formats by folder."""


def made(layout: Layout) -> list[Path]:
    """Tables and figures of a study, in all formats.

    Raises
    ------
    ValueError
        If one of them is not there.
    """
    named = [Path(path) for path in (*layout.tables, *layout.figures, *layout.map, *layout.atlas)]
    stems = list(dict.fromkeys((path.parent, path.stem) for path in named))
    files = [folder / f"{stem}.{form}" for folder, stem in stems for form in FORMS[folder.name]]
    missing = [str(path) for path in files if not path.is_file()]
    if missing:
        raise ValueError(
            f"{missing[0]}: is not there, and {len(missing) - 1} more files of the study; run it first"
        )
    return files


def worst_of_each_table(new: Path, committed: Path) -> dict[str, tuple[Grade, str]]:
    """How far each table is from the committed one: its worst column, and the finding."""
    worst: dict[str, tuple[Grade, str]] = {}
    for table, column, grade, text in compare_folders(new, committed):
        if table not in worst or grade > worst[table][0]:
            said = f"{column}: {text}" if column else text
            worst[table] = grade, said if grade > Grade.OK else ""
    return worst


def refresh(layout: Layout, committed: Path) -> list[Path]:
    """Copy tables and figures of a study into its committed folder; returns the files that went.

    Parameters
    ----------
    committed : Path
        Folder of the study's committed results.
    """
    files = made(layout)
    for name in FORMS:
        (committed / name).mkdir(parents=True, exist_ok=True)
    kept = {committed / path.parent.name / path.name for path in files}
    gone = [path for name in FORMS for path in (committed / name).iterdir() if path not in kept]
    for path in gone:
        path.unlink()
    for path in files:
        shutil.copyfile(path, committed / path.parent.name / path.name)
    return gone


@click.command()
@click.argument("names", nargs=-1, required=True, metavar="STUDY...")
@click.option("--results", default="results", show_default=True, help="Where the study was run to.")
def main(names: tuple[str, ...], results: str) -> None:
    """Take tables and figures of shipped studies (quick, paper, ...) into docs/results."""
    for name in names:
        try:
            layout = Layout(load_study(STUDIES / f"{name}.yaml"), results)
            found = worst_of_each_table(
                Path(layout.results) / "tables", COMMITTED / name / "tables"
            )
            tables = {path.name for path in made(layout)}
            gone = refresh(layout, COMMITTED / name)
            tables |= {path.name for path in gone}
        except (ValueError, FileNotFoundError) as error:
            raise click.ClickException(str(error)) from None
        for table, (grade, text) in found.items():
            if table not in tables:  # of an experiment whose table is not asked for
                continue
            click.echo(f"{grade.name.lower():8}{table:24}{text}")
        for path in gone:
            click.echo(f"removed {path.relative_to(REPOSITORY)}")
        click.echo(
            f"{COMMITTED.relative_to(REPOSITORY) / name}: look at `git diff`, then commit it"
        )


if __name__ == "__main__":
    main()
