"""The comparison of tables finds each kind of difference, and grades it."""

import pytest

from granstudy.compare import TOLERANCES, Grade, compare_folders, grade_cell, main, report

TABLE = """\
e,N,method,paper_temperature_error,paper,ratio,status
0.2,8,literal,0.9211165652,0.921116565,1.000000000,ok
0.2,64,fast,2.68e-10,2.364e-10,1.137,ok
0.2,8,fast,,0.921116565,,diverged
"""
BENCHMARK = """\
N,method,threads,seconds,speedup,transforms,status
8,fast,1,0.004,3.0,963,ok
8,fast,2,0.003,2.9,963,ok
"""


@pytest.fixture
def folders(tmp_path):
    for name in ("new", "committed"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "table1.csv").write_text(TABLE)
        (tmp_path / name / "table5.csv").write_text(BENCHMARK)
    return tmp_path / "new", tmp_path / "committed"


def grades(folders):
    return [f.grade for f in compare_folders(*folders) if f.grade is not Grade.OK]


def change(folder, old, new, name="table1.csv"):
    text = (folder / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new, 1))


def exit_code(folders):
    return main([str(folder) for folder in folders])


def test_equal_tables_are_ok(folders, capsys):
    assert grades(folders) == []
    assert exit_code(folders) == 0
    assert capsys.readouterr().out == "22 ok, 0 minor, 0 major, 0 missing\n"


@pytest.mark.parametrize(
    ("old", "new", "grade", "code"),
    [
        ("0.9211165652", "0.9211165662", None, 0),  # 1e-9 relative: round-off
        ("0.9211165652", "0.9211265652", Grade.MINOR, 0),  # 1e-5
        ("0.9211165652", "0.9221165652", Grade.MAJOR, 1),  # 1e-3
        ("2.68e-10", "2.6805e-10", None, 0),  # 5e-14 absolute: round-off
        ("2.68e-10", "2.69e-10", Grade.MINOR, 0),
        ("2.68e-10", "2.9e-9", Grade.MAJOR, 1),
        ("2.68e-10", "nan", Grade.MAJOR, 1),
        ("2.68e-10", "", Grade.MISSING, 1),
        ("fast,,", "fast,0.1,", Grade.MISSING, 1),
        ("2.364e-10", "2.365e-10", Grade.MAJOR, 1),  # what is printed cannot change
        ("1.137", "1.2", None, 0),  # follows from the others
        ("diverged", "ok", Grade.MAJOR, 1),
        (",ratio", ",ratios", Grade.MISSING, 1),
        ("0.2,64", "0.2,128", Grade.MISSING, 1),
    ],
)
def test_a_difference_is_graded(folders, old, new, grade, code):
    change(folders[0], old, new)
    found = set(grades(folders))
    assert found == (set() if grade is None else {grade})
    assert exit_code(folders) == code


def test_a_row_or_a_table_missing_in_either_folder_is_missing(folders):
    for folder, name, old in (
        (folders[0], "table1.csv", "0.2,64,fast,2.68e-10,2.364e-10,1.137,ok\n"),
        (folders[1], "table5.csv", "8,fast,1,0.004,3.0,963,ok\n"),
    ):
        change(folder, old, "", name)
    assert grades(folders) == [Grade.MISSING] * 2
    for folder in folders:
        path = folder / "table5.csv"
        text = path.read_text()
        path.unlink()
        assert Grade.MISSING in grades(folders)
        assert exit_code(folders) == 1
        path.write_text(text)


def test_folders_without_tables_do_not_pass(tmp_path):
    assert exit_code((tmp_path, tmp_path)) == 1


def test_the_order_of_rows_and_columns_is_free(folders):
    lines = TABLE.splitlines()
    swapped = [lines[0], *reversed(lines[1:])]
    (folders[0] / "table1.csv").write_text("\n".join(swapped) + "\n")
    assert grades(folders) == []


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("0.004", "0.4", []),  # seconds depend on the machine
        ("fast,2,", "fast,16,", []),  # all threads of another machine
        ("3.0", "5.0", []),
        ("3.0", "9.0", [Grade.MINOR]),
        ("3.0", "0.9", [Grade.MINOR]),
        ("3.0", "0.5", [Grade.MAJOR]),
        ("3.0", "-3.0", [Grade.MAJOR]),
        ("963", "964", [Grade.MAJOR]),
    ],
)
def test_timings_are_graded_by_what_a_machine_may_change(folders, old, new, expected):
    change(folders[0], old, new, "table5.csv")
    assert grades(folders) == expected


def test_a_column_without_a_tolerance_is_major():
    assert grade_cell("temperatur", "1.0", "1.0") is Grade.MAJOR


def test_two_rows_for_one_run_are_refused(folders):
    (folders[0] / "table1.csv").write_text(TABLE + TABLE.splitlines()[1] + "\n")
    with pytest.raises(ValueError, match="two rows for e=0.2, N=8, method=literal"):
        compare_folders(*folders)


def test_the_report_shows_what_differs_and_why_it_may(folders):
    change(folders[0], "2.68e-10", "2.9e-9")
    text = report(compare_folders(*folders))
    assert "| major | table1.csv | e=0.2, N=64, method=fast | paper_temperature_error |" in text
    assert "2.9e-9 | 2.68e-10" in text
    assert TOLERANCES["paper_temperature_error"].reason in text
    assert text.endswith("21 ok, 0 minor, 1 major, 0 missing")
