"""Files are written whole or not at all."""

import pytest

from granstudy.support.files import write_whole


def test_a_write_that_fails_leaves_what_was_there(tmp_path):
    path = tmp_path / "data.txt"
    path.write_text("before")

    def fail(partial):
        partial.write_text("half")
        raise RuntimeError("killed")

    with pytest.raises(RuntimeError):
        write_whole(path, fail)
    assert [p.name for p in tmp_path.iterdir()] == ["data.txt"]
    assert path.read_text() == "before"
