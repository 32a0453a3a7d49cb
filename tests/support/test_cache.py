"""The cache: computed once, whole or not at all, damage noticed, many runs at a time."""

import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import platformdirs
import pytest

from granstudy.support.cache import cache_folder, cached_array
from granstudy.support.files import ABANDONED

ARRAY = np.arange(3000.0).reshape(60, 50)


def never():
    raise AssertionError("computed though it is in the cache")


@pytest.fixture
def folder(monkeypatch, tmp_path):
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def test_an_array_is_computed_once(folder):
    assert cached_array("a", lambda: ARRAY) is ARRAY
    np.testing.assert_array_equal(cached_array("a", never), ARRAY)
    np.testing.assert_array_equal(cached_array("b", lambda: 2 * ARRAY), 2 * ARRAY)
    assert files(folder) == ["a.npy.sha256", "b.npy.sha256"]


@pytest.mark.parametrize("length", [0, 20, 32, 100, 24000])
def test_a_file_cut_short_is_computed_anew(folder, length):
    cached_array("a", lambda: ARRAY)
    path = folder / "a.npy.sha256"
    whole = path.read_bytes()
    assert length < len(whole)
    path.write_bytes(whole[:length])
    np.testing.assert_array_equal(cached_array("a", lambda: ARRAY), ARRAY)
    assert path.read_bytes() == whole


@pytest.mark.parametrize("place", [3, 40, 20000])
def test_a_changed_byte_is_noticed(folder, place):
    cached_array("a", lambda: ARRAY)
    path = folder / "a.npy.sha256"
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)
    np.testing.assert_array_equal(cached_array("a", lambda: ARRAY), ARRAY)
    np.testing.assert_array_equal(cached_array("a", never), ARRAY)


@pytest.mark.fault("A12")
@pytest.mark.parametrize("other", [2 * ARRAY, ARRAY[:6, :5]], ids=["equal shape", "smaller"])
def test_the_file_of_another_array_is_refused(folder, other):
    cached_array("b", lambda: other)
    cached_array("a", lambda: ARRAY)
    shutil.copy(folder / "b.npy.sha256", folder / "a.npy.sha256")
    np.testing.assert_array_equal(cached_array("a", lambda: ARRAY), ARRAY)
    np.testing.assert_array_equal(cached_array("a", never), ARRAY)


def test_a_computation_that_fails_leaves_nothing(folder):
    with pytest.raises(AssertionError):
        cached_array("a", never)
    assert not folder.exists()


def test_what_killed_processes_left_is_removed_but_not_what_others_write(folder):
    folder.mkdir()
    for name, age in (
        (".partial-old.npy", 1.01 * ABANDONED),
        (".partial-new.npy", 0.99 * ABANDONED),
    ):
        (folder / name).write_bytes(b"half")
        os.utime(folder / name, (time.time() - age,) * 2)
    cached_array("a", lambda: ARRAY)
    assert files(folder) == [".partial-new.npy", "a.npy.sha256"]


def test_readers_beside_writers_see_whole_files_only(folder):
    path = folder / "a.npy.sha256"

    def write(_):
        path.unlink(missing_ok=True)
        return cached_array("a", ARRAY.copy)

    def read(_):
        return cached_array("a", ARRAY.copy)

    with ThreadPoolExecutor(4) as pool:
        tasks = [pool.submit(task, i) for i in range(40) for task in (write, read)]
        for task in tasks:
            np.testing.assert_array_equal(task.result(), ARRAY)
    assert files(folder) == ["a.npy.sha256"]


def test_processes_that_compute_the_same_tensor(folder):
    script = (
        "import granstudy as gs; "
        "scene = gs.load_scene('bkw2d', restitution=0.5); "
        "op = gs.collision_operator(scene, gs.Solver(N=16, R=7.0, method='radial', threads=1)); "
        "print(op(scene.density(op.grid)).tobytes().hex())"
    )
    command = [sys.executable, "-c", script]
    started = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    answers = [process.communicate()[0] for process in started]
    assert answers[0] == answers[1] != ""
    assert [process.returncode for process in started] == [0, 0]
    assert len(files(folder)) == 1


@pytest.mark.fault("B12")
def test_a_folder_that_cannot_be_written_to_is_said(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.warns(UserWarning, match="cannot keep computed arrays .*Set GRANSTUDY_CACHE"):
        assert cached_array("a", lambda: ARRAY) is ARRAY


@pytest.mark.fault("B12")
def test_a_user_without_a_home_is_told(monkeypatch, tmp_path):
    for name in ("GRANSTUDY_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)

    def unknown(*args, **kwargs):
        raise RuntimeError("could not determine the home directory")

    for answer in (unknown, lambda *args, **kwargs: Path("~/.cache/granstudy")):
        monkeypatch.setattr("granstudy.support.cache.user_cache_path", answer)
        with pytest.warns(UserWarning, match="home directory.*Set GRANSTUDY_CACHE"):
            assert cached_array("a", lambda: ARRAY) is ARRAY
    assert files(tmp_path) == []


def test_the_folder_is_the_platforms_unless_one_is_named(monkeypatch, tmp_path):
    monkeypatch.delenv("GRANSTUDY_CACHE", raising=False)
    assert cache_folder() == platformdirs.user_cache_path("granstudy", appauthor=False)
    assert cache_folder().name == "granstudy" or sys.platform == "win32"
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path / "mine"))
    assert cache_folder() == tmp_path / "mine"


@pytest.mark.skipif(sys.platform != "linux", reason="the folder that caches of Linux have lain in")
@pytest.mark.parametrize(
    ("variable", "inside"), [("XDG_CACHE_HOME", "base/granstudy"), (None, ".cache/granstudy")]
)
def test_the_folder_on_linux_stays_where_it_was(monkeypatch, tmp_path, variable, inside):
    for name in ("GRANSTUDY_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    if variable:
        monkeypatch.setenv(variable, str(tmp_path / "base"))
    assert cache_folder() == tmp_path / inside
