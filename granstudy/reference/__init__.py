"""The tables printed in the paper (Hu & Ma 2019), as data."""

from importlib.resources import as_file, files

import pandas as pd

from granstudy.support.errors import unknown_name

TABLES = (1, 2, 3, 4, 5, 6, 7, 8)


def paper_table(number: int) -> pd.DataFrame:
    """Table of the paper by its number, a row for each row printed (docs/method.md §6).

    Raises
    ------
    ValueError
        If the paper has no such table.
    """
    if isinstance(number, bool) or number not in TABLES:
        raise unknown_name("table", number, [str(table) for table in TABLES])
    with as_file(files(__package__) / f"table{number}.csv") as path:
        return pd.read_csv(path)
