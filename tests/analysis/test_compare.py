import pandas as pd
import pytest

from granstudy.analysis.compare import Grade, compare_tables, main

TABLE = pd.DataFrame(
    {
        "e": [0.2, 0.8],
        "N": [8, 8],
        "paper_temperature_error": [1e-3, 2e-4],
        "seconds": [1.0, 2.0],
        "status": ["ok", "ok"],
    }
)


@pytest.fixture
def folders(tmp_path):
    for name in ("new", "committed"):
        (tmp_path / name).mkdir()
        TABLE.to_csv(tmp_path / name / "table1.csv", index=False)
    return tmp_path


def run(folders):
    return main([str(folders / "new"), str(folders / "committed")])


def test_equal_tables_pass(folders):
    assert run(folders) == 0


@pytest.mark.parametrize(
    ("column", "factor", "grade"),
    [
        ("paper_temperature_error", 1 + 1e-8, Grade.OK),
        ("paper_temperature_error", 1 + 1e-5, Grade.MINOR),
        ("paper_temperature_error", 1 + 1e-2, Grade.MAJOR),
        ("paper_temperature_error", float("nan"), Grade.MAJOR),
        ("seconds", 3.0, Grade.OK),
        ("seconds", float("nan"), Grade.MISSING),
    ],
)
def test_a_changed_number_is_graded(column, factor, grade):
    changed = TABLE.assign(**{column: TABLE[column] * factor})
    assert compare_tables(changed, TABLE)[column][0] == grade


def test_a_changed_status_is_major():
    diverged = TABLE.assign(status=["ok", "diverged"])
    assert compare_tables(diverged, TABLE)["status"][0] == Grade.MAJOR


def test_major_and_missing_fail(folders):
    path = folders / "new" / "table1.csv"
    TABLE.assign(paper_temperature_error=[1e-3, 3e-4]).to_csv(path, index=False)
    assert run(folders) == 1
    TABLE[:1].to_csv(path, index=False)
    assert compare_tables(TABLE[:1], TABLE)["rows"][0] == Grade.MISSING
    assert run(folders) == 1
    TABLE.drop(columns="status").to_csv(path, index=False)
    assert run(folders) == 1
    path.unlink()
    assert run(folders) == 1
    (folders / "committed" / "table1.csv").unlink()
    assert run(folders) == 1, "two empty folders show nothing"
