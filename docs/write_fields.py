"""Write the reference of study files from their model: ``python docs/write_fields.py`` writes `fields.md`.

Fields, types, defaults, allowed values and texts are those of the JSON schema, which pydantic makes from the
typed sections (`granstudy.study.schema`). A test says when the page is due.
"""

import dataclasses
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from granstudy.analysis.vocabulary import study_schema
from granstudy.model.solver import Solver
from granstudy.support.files import write_text

PAGE = Path(__file__).parent / "fields.md"

HEAD = """# Every field of a study file

Written by `python docs/write_fields.py` from the model that checks study files. [Study files](studies.md)
explains them in order of use. What is not listed here is refused, with "did you mean".
[Units](units.md) are those of a velocity V, a time 𝒯 and a density n.
"""

EXPERIMENTS = {
    "EvolutionExperiment": "evolution",
    "CollisionExperiment": "collision",
    "BenchmarkExperiment": "benchmark",
    "StateExperiment": "state",
    "LabelsExperiment": "labels",
}
"""Sections that are one table, with the kind of run that each stands for."""

SECTIONS = {
    "": "A study",
    "experiments": "An experiment",
    "RangeModel": "A range",
    "SceneModel": "Scene",
    "ViscoelasticModel": "Viscoelastic",
    "SolverModel": "Solver",
    "TimeModel": "Time",
    "TimesModel": "Times",
    "RefineModel": "Refine",
    "AccuracyModel": "Accuracy",
    "TruthModel": "Truth",
    "TableModel": "Table",
    "EvolutionTableModel": "Table of an evolution",
    "StateTableModel": "Table of states",
    "AverageModel": "Average",
    "FitModel": "Fit",
    "FigureModel": "Figure",
    "TimingModel": "Timing",
    "MapModel": "Map",
    "AtlasModel": "Atlas",
}
"""Headings by section, in the order of the page."""

SAME_AS = {"SceneFields": "SceneModel", "TimeFields": "TimeModel"}
"""Sections without a table of their own: all but the first field of another one."""

UNITS = {
    ("SceneModel", "temperature"): "V²",
    ("SceneModel", "velocity"): "V",
    ("SceneModel", "separation"): "V",
    ("SceneModel", "diffusion"): "V²/𝒯",
    ("SceneModel", "strength"): "V^−λ/(n𝒯)",
    ("SceneModel", "A"): "V^−1/5",
    ("ViscoelasticModel", "viscoelastic"): "V^−1/5",
    ("SolverModel", "R"): "V",
    ("TimeModel", "dt"): "𝒯",
    ("TimeModel", "t_final"): "𝒯",
    ("TimeModel", "times"): "𝒯",
    ("TimesModel", "first"): "𝒯",
    ("TimesModel", "last"): "𝒯",
    ("AverageModel", "start"): "𝒯",
    ("RefineModel", "R"): "V",
}
"""Units of fields that have one, in those of velocity V, time 𝒯 and number density n."""

TEXTS = {
    "title": "what stands above",
    "experiments": "experiments by name; their files get the names",
    "map": "a table and a figure of all experiments with a truth",
    "atlas": "one dataset and a figure of all states to an accuracy",
    "run": "the kind of run",
    "scene": "which gas, as all runs share it",
    "solver": "which method and grid, as all runs share them",
    "time": "how it goes through time, as all runs share it",
    "table": "what the table holds",
    "fit": "what is fitted to the runs",
    "figure": "what is drawn",
    "timing": "how it is timed",
    "kind": "the kind of figure",
    "law": "the law that is fitted",
    "t_final": "how long",
}
"""Texts of fields whose section says what they are."""

LIMITS = {
    "minimum": "≥ {}",
    "maximum": "≤ {}",
    "exclusiveMinimum": "> {}",
    "exclusiveMaximum": "< {}",
    "minItems": "at least {} of them",
}

TYPES = {
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
}


def page() -> str:
    """The whole page."""
    schema = study_schema()
    parts = [HEAD, *(_section(schema, name) for name in SECTIONS)]
    return "\n".join(parts)


def _section(schema: dict[str, Any], name: str) -> str:
    """Heading, first line of the section's docstring, and table of its fields."""
    lines = [f"## {SECTIONS[name]}\n"]
    if name == "experiments":
        lines.append("What one kind of run has alone is marked.\n")
        rows = _rows_of_experiments(schema)
    else:
        section = schema["$defs"][name] if name else schema
        lines.append(_text(section.get("description", "").split("\n\n")[0]) + "\n")
        rows = [_row(name, field, of, section) for field, of in section["properties"].items()]
    head = ("field", "type", "default", "allowed", "unit", "what it is")
    lines += [_line(head), _line(("---",) * len(head)), *map(_line, rows)]
    return "\n".join(lines) + "\n"


def _rows_of_experiments(schema: dict[str, Any]) -> Iterator[list[str]]:
    """Fields of all kinds of experiments, each once."""
    kinds: dict[str, list[str]] = {}
    for section, kind in EXPERIMENTS.items():
        for field in schema["$defs"][section]["properties"]:
            kinds.setdefault(field, []).append(kind)
    for field, of in kinds.items():
        owner = next(section for section, kind in EXPERIMENTS.items() if kind == of[0])
        section = schema["$defs"][owner]
        row = _row(owner, field, section["properties"][field], section)
        if field == "run":
            row[3] = ", ".join(f"`{kind}`" for kind in EXPERIMENTS.values())
        if field == "table":
            row[1] = (
                "[table](#table), [of an evolution](#table-of-an-evolution), [of states](#table-of-states)"
            )
        if len(of) < len(EXPERIMENTS):
            row[5] += f" (of {', '.join(of)})"
        yield row


def _row(name: str, field: str, of: dict[str, Any], section: dict[str, Any]) -> list[str]:
    kinds, allowed = _kinds(of)
    default = "must be given" if field in section.get("required", ()) else _default(name, field, of)
    text = _text(of.get("description", "") or TEXTS[field])
    return [f"`{field}`", " or ".join(kinds), default, allowed, UNITS.get((name, field), ""), text]


def _kinds(of: dict[str, Any]) -> tuple[list[str], str]:
    """Types that a field may have, and which of their values."""
    kinds, allowed = [], []
    for one in of.get("anyOf", [of]):
        kind, values = _kind(one)
        if kind and kind not in kinds:
            kinds.append(kind)
        if values:
            allowed.append(values)
    if "number" in kinds and "whole number" in kinds:
        kinds.remove("whole number")
    return kinds, "; ".join(allowed)


def _kind(one: dict[str, Any]) -> tuple[str, str]:
    """A type and its values, in words; of null nothing."""
    limits = [text.format(one[name]) for name, text in LIMITS.items() if name in one]
    if "$ref" in one:
        name = one["$ref"].rpartition("/")[2]
        heading = SECTIONS[SAME_AS.get(name, name)]
        return f"[{heading.lower()}](#{heading.lower().replace(' ', '-')})", ""
    if "const" in one or "enum" in one:
        values = one.get("enum", [one.get("const")])
        return "text", ", ".join(f"`{value}`" for value in values)
    if one.get("type") == "array":
        inner, _ = _kinds(one["items"])
        return f"list of {' or '.join(inner)}", ", ".join(limits)
    if one.get("type") == "object":
        return "names with values", ""
    return TYPES.get(one.get("type", ""), ""), ", ".join(limits)


def _default(name: str, field: str, of: dict[str, Any]) -> str:
    value = of.get("default")
    if name == "SolverModel" and value is None:
        known = {one.name: one.default for one in dataclasses.fields(Solver)}
        value = None if known[field] is dataclasses.MISSING else known[field]
    if value is None or isinstance(value, dict) or value == []:
        return ""
    return f"`{value if isinstance(value, str) else json.dumps(value)}`"


def _text(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _line(cells: Any) -> str:
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    write_text(PAGE, page())
