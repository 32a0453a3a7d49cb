"""Checkpoints: every state comes back as it was, and they are as rare as they are told to be."""

import json
import threading

import numpy as np
import pytest

from granstudy.datasets.storage import checkpoint
from granstudy.datasets.storage.checkpoint import VARIABLE, Checkpoint

IDENTITY = {"scene": {"e": 0.5, "u": (0.0, 1.0)}, "code": "abc"}


def same(a, b):
    """Whether two pieces of plain data are equal to the bit, types and layouts of arrays included."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, np.ndarray):
        return (a.dtype, a.shape, a.strides) == (b.dtype, b.shape, b.strides) and (
            a.tobytes() == b.tobytes()
        )
    return type(a) is type(b) and (a == b or (a != a and b != b))


def test_a_state_comes_back_with_its_types_bits_and_layout(tmp_path):
    values = np.random.default_rng(1).normal(size=(3, 4, 5))
    state = {
        "numbers": [1, 2**127 + 1, -0.0, 0.1, float("inf"), float("nan"), True, None, "∂t f\n"],
        "of numpy": [np.float64(0.1), np.float32(0.1), np.int8(3), np.complex128(1 + 2j)],
        "arrays": {
            "plain": values,
            "transposed": values.transpose(1, 2, 0),
            "fortran": np.asfortranarray(values),
            "single": values.astype(np.float32),
            "complex": values + 1j,
            "empty": np.zeros(0),
            "no axis": np.array(2.5),
            "whole": np.arange(3),
        },
        "nothing": {},
        "nested": [[{"a": [values[0]]}], []],
    }
    one = Checkpoint(tmp_path / "a", IDENTITY)
    assert one.read() is None
    one.write(state)
    assert same(Checkpoint(tmp_path / "a", IDENTITY).read(), state)
    one.remove()
    assert one.read() is None


def test_a_view_with_gaps_comes_back_dense(tmp_path):
    values = np.random.default_rng(1).normal(size=(4, 6)) + 1j
    one = Checkpoint(tmp_path / "a", IDENTITY)
    one.write({"real": values.real, "some": values[::2, ::-3]})
    found = one.read()
    np.testing.assert_array_equal(found["real"], values.real)
    np.testing.assert_array_equal(found["some"], values[::2, ::-3])


class Clock:
    """Seconds that pass when they are told to."""

    def __init__(self, monkeypatch):
        self.now = 1000.0
        monkeypatch.setattr(checkpoint.time, "monotonic", lambda: self.now)


@pytest.mark.parametrize(
    ("text", "taken", "pause"), [(None, 0.1, 60.0), (None, 3.0, 300.0), ("5", 0.01, 5.0)]
)
def test_checkpoints_come_by_the_clock_and_take_a_hundredth_of_the_time(
    tmp_path, monkeypatch, text, taken, pause
):
    clock = Clock(monkeypatch)
    monkeypatch.delenv(VARIABLE, raising=False)
    if text is not None:
        monkeypatch.setenv(VARIABLE, text)
    one, first = Checkpoint(tmp_path / "a", IDENTITY), float(text or 60.0)
    clock.now += first - 0.01
    assert not one.due()
    clock.now += 0.02
    assert one.due()

    def slow(path, write):
        clock.now += taken

    monkeypatch.setattr(checkpoint, "write_whole", slow)
    one.write({})
    clock.now += pause - 0.01
    assert not one.due()
    clock.now += 0.02
    assert one.due()


def test_zero_seconds_write_every_step_and_inf_none(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "0")
    one = Checkpoint(tmp_path / "a", IDENTITY)
    one.write({})
    assert one.due()
    monkeypatch.setenv(VARIABLE, "inf")
    clock = Clock(monkeypatch)
    one = Checkpoint(tmp_path / "a", IDENTITY)
    clock.now += 1e9
    assert not one.due()


def test_two_that_write_the_same_checkpoint_do_each_other_no_harm(tmp_path):
    path, states = tmp_path / "a", [{"a": np.full(50_000, float(k))} for k in range(2)]
    writers = [Checkpoint(path, IDENTITY) for _ in states]
    writers[0].write(states[0])
    stop = threading.Event()

    def write(one, state):
        while not stop.is_set():
            one.write(state)

    threads = [
        threading.Thread(target=write, args=pair) for pair in zip(writers, states, strict=True)
    ]
    for thread in threads:
        thread.start()
    try:
        for _ in range(50):
            found = Checkpoint(path, json.loads(json.dumps(IDENTITY))).read()
            assert any(same(found, state) for state in states)
    finally:
        stop.set()
        for thread in threads:
            thread.join()
    assert [file.name for file in tmp_path.iterdir()] == ["a"]
