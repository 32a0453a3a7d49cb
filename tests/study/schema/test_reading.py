"""YAML of study files: what is not read, and the line that says so."""

import subprocess
import sys

import pytest

from granstudy.study.schema.reading import DEEPEST, LARGEST_FILE, MOST_NODES, read_yaml


@pytest.fixture
def read(tmp_path):
    """Read bytes as a study file."""

    def read(content):
        path = tmp_path / "study.yaml"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_yaml(path)

    return read


def nine_fold(levels):
    """Aliases, each nine times in the next."""
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    for level in range(1, levels):
        lines.append(f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * 9)}]")
    return "\n".join(lines)


@pytest.mark.fault("A11")
@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("sweep: 1\nsweep: 2", "line 2: key 'sweep': is given twice, first in line 1"),
        ("a: {b: 1, b: 2}", "line 1: key 'b': is given twice"),
        ("a: &x {b: 1, b: 2}\nc: {<<: *x}", "line 1: key 'b': is given twice"),
        (b"title: \xe9", "is not UTF-8 .byte 7.; save it as UTF-8"),
        ("title: é".encode("utf-16"), "is not UTF-8"),
        ("circular: !!bool maybe", "line 1: tag !!bool: tags are not read; write the value alone"),
        ("a: !!python/object/apply:os.getpid []", "tag !!python/object/apply:os.getpid"),
        ("a: !!str 5", "tag !!str"),
        ("[" * 100_000, f"line 1: more than {DEEPEST} sections inside each other"),
        ("- " * 10_000, f"more than {DEEPEST} sections"),
        (nine_fold(9), f"more than {MOST_NODES} keys and values, aliases written out"),
        ("a: &a [*a]", "an alias stands inside of what it stands for"),
        ("[" + "1," * (MOST_NODES + 1) + "]", f"more than {MOST_NODES} keys and values"),
        ("#" * (LARGEST_FILE + 1), "a study file has 1000000 bytes at most"),
        ("N: " + "9" * 400, r"value 999999999999... .400 digits.: must be a whole number below 2"),
        ("N: -9223372036854775809", "must be a whole number below 2"),
        ("R: .inf", "value .inf: must be a finite number"),
        ("R: -.inf", "must be a finite number"),
        ("R: .nan", "value .nan: must be a finite number"),
        ("R: 1.0e+400", "value 1.0e.400: must be a finite number"),
        ("N: 032", "value 032: YAML reads it in base 8"),
        ("t_final: 1:30", "value 1:30: YAML reads it in base 60"),
        ("t_final: 1:30.5", "value 1:30.5: YAML reads it in base 60"),
        ("no: 1", "line 1: key no: must be a text; write it in quotes"),
        ("1: 2", "key 1: must be a text"),
        ("[1, 2]: 3", "key a list or a section: must be a text"),
        (r'title: "\ud800"', "character '.ud800' in a text"),
        (r'title: "\0"', "character '.x00' in a text"),
        ("title: " + "x" * 3000, "has 3000 characters; a text has 2000 at most"),
        ("a: *b", "not YAML: line 1: found undefined alias 'b'"),
        ("a: [1, 2", "not YAML: line 1: while parsing a flow sequence"),
        ("a: 1\n---\nb: 2", "not YAML: line 2: expected a single document"),
        ("\x01", "not YAML: unacceptable character"),
    ],
)
def test_what_is_not_read_is_one_line_with_the_file(read, content, message):
    with pytest.raises(ValueError, match=message) as error:
        read(content)
    (line,) = str(error.value).splitlines()
    assert "study.yaml: " in line and len(line) < 500


def test_what_is_read_as_it_looks(read):
    text = "a: 2020-01-31\nb: =\nc: 0\nd: -0.5\ne: 1_000\nf: 0x1F\ng: ü\nh:\ni: 'no'\n"
    found = {"a": "2020-01-31", "b": "=", "c": 0, "d": -0.5, "e": 1000, "f": 31, "g": "ü"}
    assert read(text) == found | {"h": None, "i": "no"}
    assert read(b"\xef\xbb\xbftitle: t") == {"title": "t"}
    assert read("a: &a {b: 1}\nc: {<<: *a, b: 2}") == {"a": {"b": 1}, "c": {"b": 2}}


def test_files_are_utf8_whatever_the_locale(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_bytes("title: λ = ½".encode())
    code = f"from granstudy.study.schema.reading import read_yaml; print(ascii(read_yaml({str(path)!r})))"
    settings = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [
        "env",
        *(f"{name}={value}" for name, value in settings.items()),
        sys.executable,
        "-c",
    ]
    ran = subprocess.run([*command, code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == r"{'title': '\u03bb = \xbd'}"
