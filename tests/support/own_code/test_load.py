"""Functions from files, by reference."""

import multiprocessing
import pickle
import sys

import cloudpickle
import pytest
from own_functions import in_file

from granstudy.support.own_code.load import load_function

GAS = "K = 2.0\n\ndef thermal(vx, vy, T=1.0):\n    return K * vx * vy * T\n\nNUMBER = 3\n"


def call(function, *arguments):
    return function(*arguments)


def test_a_reference_is_relative_to_a_folder_or_absolute(tmp_path):
    path = in_file(tmp_path / "gases", GAS)
    for reference in ("gases/my_gas.py:thermal", f"{path}:thermal"):
        function = load_function(reference, tmp_path)
        assert function(1.0, 2.0, T=3.0) == 12.0
        assert repr(function) == function.reference == "my_gas.py:thermal"
    assert function == load_function("my_gas.py:thermal", path.parent)
    assert len({function, load_function("my_gas.py:thermal", path.parent)}) == 1


def test_an_edited_file_is_another_function(tmp_path):
    in_file(tmp_path, GAS)
    first = load_function("my_gas.py:thermal", tmp_path)
    assert load_function("my_gas.py:thermal", tmp_path).own_function is first.own_function
    in_file(tmp_path, GAS.replace("2.0", "3.0"))
    second = load_function("my_gas.py:thermal", tmp_path)
    assert (first(1.0, 1.0), second(1.0, 1.0)) == (2.0, 3.0)
    assert first != second


def test_files_of_one_name_in_two_folders_are_two(tmp_path):
    for folder, value in (("a", 1), ("b", 2)):
        in_file(tmp_path / folder, "from helper import VALUE\ndef f(x, y):\n    return VALUE\n")
        in_file(tmp_path / folder, f"VALUE = {value}\n", "helper.py")
    before = set(sys.modules)
    found = [load_function(f"{folder}/my_gas.py:f", tmp_path)(0, 0) for folder in ("a", "b", "a")]
    assert found == [1, 2, 1]
    assert not {"helper", "my_gas"} & (set(sys.modules) - before)
    assert str(tmp_path / "a") not in sys.path


@pytest.mark.parametrize("pickler", [pickle, cloudpickle])
def test_a_spawned_process_loads_it_again(tmp_path, pickler):
    in_file(tmp_path, GAS)
    function = load_function("my_gas.py:thermal", tmp_path)
    same = pickler.loads(pickler.dumps(function))
    assert same == function
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(call, (function, 1.0, 2.0)) == 4.0


def test_a_process_refuses_a_file_that_was_edited_meanwhile(tmp_path):
    in_file(tmp_path, GAS)
    sent = pickle.dumps(load_function("my_gas.py:thermal", tmp_path))
    in_file(tmp_path, GAS.replace("2.0", "3.0"))
    with pytest.raises(
        ValueError, match="my_gas.py:thermal: .*was edited since the function was sent"
    ):
        pickle.loads(sent)


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        ("my_gas.py", "'my_gas.py': is no reference to a function; write it as file.py:function"),
        ("my_gas:thermal", "'my_gas:thermal': is no reference"),
        ("my_gas.py:a b", "'my_gas.py:a b': is no reference"),
        (
            "my_gaz.py:thermal",
            "no file .*my_gaz.py .did you mean 'my_gas.py'.*; there are .*my_gas.py",
        ),
        ("my_gas.py:termal", "has no 'termal' .did you mean 'thermal'.*; it has thermal"),
        ("my_gas.py:NUMBER", "my_gas.py:NUMBER: is 3, not a function; my_gas.py has thermal"),
        ("syntax.py:f", "syntax.py:f: .*syntax.py, line 2: "),
        ("raises.py:f", "raises.py:f: .*raises.py, line 3: ZeroDivisionError: division by zero"),
        ("beside.py:f", "beside.py:f: .*raises.py, line 3: ZeroDivisionError"),
        ("leaves.py:f", "leaves.py:f: .*line 1: SystemExit: 2"),
        ("latin.py:f", "latin.py:f: .*latin.py"),
        ("noisy.py:f", "noisy.py:f: .*'RNG' is of type numpy.random._generator.Generator"),
    ],
)
def test_what_is_wrong_is_said_in_one_error(tmp_path, reference, message):
    in_file(tmp_path, GAS)
    in_file(tmp_path, "x = 1\ndef f(:\n", "syntax.py")
    in_file(tmp_path, "x = 0\n\ny = 1 / x\n", "raises.py")
    in_file(tmp_path, "import raises\n", "beside.py")
    in_file(tmp_path, "raise SystemExit(2)\n", "leaves.py")
    in_file(
        tmp_path, "import numpy\nRNG = numpy.random.default_rng()\nf = lambda v: RNG\n", "noisy.py"
    )
    (tmp_path / "latin.py").write_bytes(b"x = '\xe9'\n")
    with pytest.raises(ValueError, match=message):
        load_function(reference, tmp_path)
