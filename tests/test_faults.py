"""Every fault that was found once has a test that keeps it from coming back (tests/faults.toml)."""

import ast
import tomllib
from pathlib import Path

TESTS = Path(__file__).parent


def faults():
    """Sentence of each fault by its name."""
    content = tomllib.loads((TESTS / "faults.toml").read_text(encoding="utf-8"))
    return {name: said for table in content.values() for name, said in table.items()}


def marked():
    """Tests of each fault by its name."""
    found = {}
    for path in sorted(TESTS.rglob("test_*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            for decorator in getattr(node, "decorator_list", ()):
                if ast.unparse(decorator).startswith("pytest.mark.fault("):
                    assert node.name.startswith("test_"), f"{path}: {node.name} is no test"
                    for name in map(ast.literal_eval, decorator.args):
                        found.setdefault(name, []).append(f"{path.relative_to(TESTS)}::{node.name}")
    return found


def test_every_fault_has_a_test_and_every_name_is_known():
    tests, known = marked(), faults()
    assert [name for name in known if name not in tests] == []
    assert {name: found for name, found in tests.items() if name not in known} == {}


def test_a_fault_is_said_in_one_sentence():
    for name, said in faults().items():
        assert said.endswith(".") and "\n" not in said and len(said) < 130, name
