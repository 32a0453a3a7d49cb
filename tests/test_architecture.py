"""The house keeps its walls (`tests/architecture.py`): each rule holds, and each rule can fail."""

import re
from pathlib import Path

import pytest
from architecture import (
    APART,
    FLOORS,
    FORKS,
    HOUSE,
    circles,
    entries,
    floor,
    imports,
    modules,
    room,
)

LARGEST_FILE = 400
"""Lines."""

LARGEST_ROOM = 12
"""Files and folders in a folder of the package, without its ``__init__.py``."""

BESIDE_THE_ROOMS = {"promises", "workflow"}
"""Folders of tests of what is no room of the package."""


def every_room_has_a_floor(house: Path) -> list[str]:
    rooms = {path.parent.name for path in house.glob("*/__init__.py")}
    return sorted(rooms ^ {name for names in FLOORS for name in names})


def only_init_stands_in_no_room(house: Path) -> list[str]:
    return [path.name for path in house.glob("*.py") if path.name != "__init__.py"]


def imports_lead_down(house: Path) -> list[str]:
    return [
        str(one)
        for one in imports(house)
        if (importer := room(one.importer)) != (imported := room(one.imported))
        and (floor(imported) >= floor(importer) or (importer, imported) in APART)
    ]


def no_circle(house: Path) -> list[str]:
    return circles(imports(house))


def imports_stand_open(house: Path) -> list[str]:
    return [str(one) for one in imports(house) if one.how != "open"]


def nothing_imports_what_a_string_names(house: Path) -> list[str]:
    return [
        f"{name}: {call}"
        for name, path in modules(house).items()
        for call in re.findall(r"import_module|__import__", path.read_text(encoding="utf-8"))
    ]


def forks_are_known(house: Path) -> list[str]:
    return [
        name
        for name, path in modules(house).items()
        if re.search(r"^FORK\b", path.read_text(encoding="utf-8"), re.M) and name not in FORKS
    ]


def no_relative_import(house: Path) -> list[str]:
    return [
        f"{name}: {line}"
        for name, path in modules(house).items()
        for line in re.findall(r"^\s*from +\.[^\n]*", path.read_text(encoding="utf-8"), re.M)
    ]


def rooms_are_small(house: Path) -> list[str]:
    folders = [folder for folder in house.rglob("*") if (folder / "__init__.py").is_file()]
    sizes = {folder.relative_to(house.parent): len(entries(folder)) for folder in folders}
    return [f"{folder}: {size}" for folder, size in sizes.items() if size > LARGEST_ROOM]


def files_are_small(house: Path) -> list[str]:
    paths = [*house.rglob("*.py"), *(house.parent / "tests").rglob("*.py")]
    lines = {path: path.read_text(encoding="utf-8").count("\n") for path in paths}
    return [f"{path.name}: {count}" for path, count in lines.items() if count > LARGEST_FILE]


def rooms_of_tests_are_rooms(house: Path) -> list[str]:
    tests = house.parent / "tests"
    return [
        str(path.relative_to(tests))
        for path in sorted(tests.rglob("*.py"))
        if (place := path.parent.relative_to(tests)).parts
        and place.parts[0] not in BESIDE_THE_ROOMS
        and not (house / place / "__init__.py").is_file()
    ]


RULES = (
    every_room_has_a_floor,
    only_init_stands_in_no_room,
    imports_lead_down,
    no_circle,
    imports_stand_open,
    nothing_imports_what_a_string_names,
    forks_are_known,
    no_relative_import,
    rooms_are_small,
    files_are_small,
    rooms_of_tests_are_rooms,
)


@pytest.mark.parametrize("rule", RULES)
def test_the_house_keeps_its_walls(rule):
    assert not (broken := rule(HOUSE)), "\n".join(broken)


def made_up(root: Path, files: dict[str, str]) -> Path:
    """A house of a file in every room, and these."""
    plain = {f"granstudy/{name}/__init__.py": "" for names in FLOORS for name in names}
    for path, text in ({"granstudy/__init__.py": ""} | plain | files).items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text)
    return root / "granstudy"


LAZY = "def f():\n    from granstudy.support import b\n"
TYPE_ONLY = (
    "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from granstudy.model.b import B\n"
)
OTHER = "granstudy/model/b.py"


@pytest.mark.parametrize(
    ("rule", "files", "found"),
    [
        (every_room_has_a_floor, {"granstudy/attic/__init__.py": ""}, ["attic"]),
        (only_init_stands_in_no_room, {"granstudy/utils.py": ""}, ["utils.py"]),
        (
            imports_lead_down,
            {"granstudy/velocity/a.py": "import granstudy.model.b", OTHER: ""},
            ["granstudy.velocity.a -> granstudy.model.b (open)"],
        ),
        (
            imports_lead_down,
            {"granstudy/theory/a.py": "from granstudy.collision import Q"},
            ["granstudy.theory.a -> granstudy.collision (open)"],
        ),
        (
            imports_lead_down,
            {"granstudy/trust/a.py": "from granstudy import collision, theory"},
            ["granstudy.trust.a -> granstudy.collision (open)"],
        ),
        (
            imports_lead_down,
            {"granstudy/study/a.py": "from granstudy import simulate"},
            ["granstudy.study.a -> granstudy (open)"],
        ),
        (
            no_circle,
            {"granstudy/model/a.py": TYPE_ONLY, OTHER: "def f():\n    import granstudy.model.a"},
            ["granstudy.model.a -> granstudy.model.b -> granstudy.model.a"],
        ),
        (
            no_circle,
            {
                "granstudy/model/__init__.py": "from granstudy.model.b import g",
                OTHER: "from granstudy.model import f",
            },
            ["granstudy.model -> granstudy.model.b -> granstudy.model"],
        ),
        (
            imports_stand_open,
            {"granstudy/model/a.py": TYPE_ONLY, OTHER: ""},
            ["granstudy.model.a -> granstudy.model.b (type-only)"],
        ),
        (
            imports_stand_open,
            {"granstudy/model/a.py": LAZY, "granstudy/support/b.py": ""},
            ["granstudy.model.a -> granstudy.support.b (lazy)"],
        ),
        (
            imports_stand_open,
            {"granstudy/study/a.py": "MAKER = 'granstudy.model.b:make'", OTHER: ""},
            ["granstudy.study.a -> granstudy.model.b (by string)"],
        ),
        (
            nothing_imports_what_a_string_names,
            {"granstudy/model/a.py": "from importlib import import_module"},
            ["granstudy.model.a: import_module"],
        ),
        (
            forks_are_known,
            {
                "granstudy/trust/a.py": "FORK = True\n",
                "granstudy/evolution/simulate.py": "FORK = 1",
            },
            ["granstudy.trust.a"],
        ),
        (
            no_relative_import,
            {"granstudy/model/a.py": "from .b import f", OTHER: ""},
            ["granstudy.model.a: from .b import f"],
        ),
        (
            rooms_are_small,
            {f"granstudy/model/{letter}.py": "" for letter in "abcdefghijklm"},
            ["granstudy/model: 13"],
        ),
        (files_are_small, {"granstudy/model/a.py": "a = 1\n" * 401}, ["a.py: 401"]),
        (files_are_small, {"tests/model/test_a.py": "a = 1\n" * 401}, ["test_a.py: 401"]),
        (rooms_of_tests_are_rooms, {"tests/modle/test_a.py": ""}, ["modle/test_a.py"]),
    ],
)
def test_the_rule_can_fail(tmp_path, rule, files, found):
    assert rule(made_up(tmp_path, files)) == found


@pytest.mark.parametrize("rule", RULES)
def test_the_rule_lets_a_sound_house_be(tmp_path, rule):
    house = made_up(
        tmp_path,
        {
            "granstudy/__init__.py": "from granstudy.evolution.simulate import simulate",
            "granstudy/evolution/simulate.py": "def f():\n    import numpy",
            "granstudy/model/a.py": '"""See\n\ngranstudy.study"""\nfrom granstudy.model.b import B',
            OTHER: "A = 1\n'granstudy.study'\n",
            "granstudy/support/b.py": "from pathlib import Path",
            "tests/model/test_a.py": "",
            "tests/workflow/test_workflow.py": "",
        },
    )
    assert not rule(house)
