"""YAML of study files, read strictly: what says something else than it seems to is an error with its line."""

import math
import unicodedata
from pathlib import Path
from typing import Any, NoReturn

import yaml

from granstudy.study.schema.values import shown

LARGEST_FILE = 1_000_000
"""Bytes of a study file at most; ranges say many values in few."""

DEEPEST = 30
"""Sections inside each other at most."""

MOST_NODES = 100_000
"""Keys and values at most, once aliases are written out."""

LONGEST_TEXT = 2000
"""Characters of a text at most."""

LARGEST_WHOLE = 2**63 - 1
"""Largest size of a whole number."""


def read_yaml(path: str | Path) -> Any:
    """The content of a YAML file: dicts, lists, texts, numbers, true, false and None.

    The file is UTF-8, whatever the locale.

    Raises
    ------
    ValueError
        One line, with the file and the line in it: for what is not UTF-8 or not YAML; for a key that is given
        twice or is no text; for tags, control characters, numbers that are not finite or that YAML reads in
        base 8 or 60; for more than `LARGEST_FILE`, `DEEPEST` or `MOST_NODES`.
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise ValueError(f"study {shown(str(path))}: no such file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise ValueError(f"study {shown(str(path))}: {error.strerror}") from None
    if len(content) > LARGEST_FILE:
        raise ValueError(
            f"{path}: a study file has {LARGEST_FILE} bytes at most (a range, {{start, stop, count}}, says "
            "many values in few)"
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: is not UTF-8 (byte {error.start}); save it as UTF-8") from None
    try:
        return yaml.load(text, _Loader)  # a SafeLoader
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f"line {mark.line + 1}: " if mark else ""
        about = f"{error.context}, {error.problem}" if error.context else str(error.problem)
        what = "" if isinstance(error, _Refused) else "not YAML: "
        raise ValueError(f"{path}: {what}{line}{about}") from None
    except yaml.YAMLError as error:
        raise ValueError(f"{path}: not YAML: {' '.join(str(error).split())}") from None


class _Refused(yaml.MarkedYAMLError):
    """What is YAML, and refused all the same."""


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader without what reads something else than it seems to."""

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self.depth = self.nodes = 0
        self.checked: set[int] = set()

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        tag = getattr(event, "tag", None)
        if tag not in (None, "!"):
            short = tag.replace("tag:yaml.org,2002:", "!!")
            _refuse(f"tag {short}: tags are not read; write the value alone", event)
        if self.depth > DEEPEST:
            _refuse(f"more than {DEEPEST} sections inside each other", event)
        if self.nodes > MOST_NODES:
            _refuse(f"more than {MOST_NODES} keys and values", event)
        self.nodes += 1
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def get_single_data(self) -> Any:
        node = self.get_single_node()
        if node is None:
            return None
        _count(node, {}, set())
        return self.construct_document(node)

    def flatten_mapping(self, node: Any) -> None:
        # Here the keys are still those that are written; merged ones come after.
        if id(node) not in self.checked:
            self.checked.add(id(node))
            _check_keys(node)
        super().flatten_mapping(node)


TEXT, MERGE = "tag:yaml.org,2002:str", "tag:yaml.org,2002:merge"
"""Tags of keys."""


def _refuse(problem: str, node: Any) -> NoReturn:
    raise _Refused(None, None, problem, node.start_mark)


def _check_keys(node: Any) -> None:
    lines: dict[str, int] = {}
    for key, _ in node.value:
        if key.tag not in (TEXT, MERGE):
            shown = key.value if isinstance(key, yaml.ScalarNode) else "a list or a section"
            _refuse(f"key {shown}: must be a text; write it in quotes", key)
        if key.value in lines:
            first = lines[key.value] + 1
            _refuse(f"key {key.value!r}: is given twice, first in line {first}", key)
        lines[key.value] = key.start_mark.line


def _count(node: Any, sizes: dict[int, int], above: set[int]) -> int:
    """Keys and values of a node with its aliases written out."""
    if id(node) in sizes:
        return sizes[id(node)]
    if id(node) in above:
        _refuse("an alias stands inside of what it stands for", node)
    inner: list[Any] = []
    if isinstance(node, yaml.MappingNode):
        inner = [part for pair in node.value for part in pair]
    elif isinstance(node, yaml.SequenceNode):
        inner = node.value
    above.add(id(node))
    size = 1 + sum(_count(part, sizes, above) for part in inner)
    above.discard(id(node))
    if size > MOST_NODES:
        _refuse(f"more than {MOST_NODES} keys and values, aliases written out", node)
    sizes[id(node)] = size
    return size


def _text(loader: _Loader, node: Any) -> str:
    value: str = loader.construct_scalar(node)
    if len(value) > LONGEST_TEXT:
        _refuse(
            f"text {value[:20]!r}... has {len(value)} characters; a text has {LONGEST_TEXT} at most",
            node,
        )
    for character in value:
        if unicodedata.category(character) in ("Cc", "Cs") and character not in "\n\t":
            _refuse(f"character {character!a} in a text: must be one that can be written", node)
    return value


def _whole(loader: _Loader, node: Any) -> int:
    written = node.value.replace("_", "")
    digits = written.lstrip("+-")
    if ":" in written or (digits.startswith("0") and digits.isdigit() and int(digits) != 0):
        base = 60 if ":" in written else 8
        _refuse(
            f"value {node.value}: YAML reads it in base {base}; write a decimal number, or text in quotes",
            node,
        )
    if len(digits) > 70:
        _refuse(_too_large(node), node)
    value: int = loader.construct_yaml_int(node)
    if abs(value) > LARGEST_WHOLE:
        _refuse(_too_large(node), node)
    return value


def _too_large(node: Any) -> str:
    shown = (
        node.value if len(node.value) < 40 else f"{node.value[:12]}... ({len(node.value)} digits)"
    )
    return f"value {shown}: must be a whole number below 2^63"


def _real(loader: _Loader, node: Any) -> float:
    if ":" in node.value:
        _refuse(f"value {node.value}: YAML reads it in base 60; write a decimal number", node)
    value: float = loader.construct_yaml_float(node)
    if not math.isfinite(value):
        _refuse(f"value {node.value}: must be a finite number", node)
    return value


def _date(loader: _Loader, node: Any) -> str:
    """A date is text, as no field takes one."""
    return _text(loader, node)


for _tag, _construct in (
    ("str", _text), ("int", _whole), ("float", _real), ("timestamp", _date), ("value", _text),
):  # fmt: skip
    _Loader.add_constructor(f"tag:yaml.org,2002:{_tag}", _construct)
