"""One line for each thing wrong in a study file: what pydantic found, and what the sections take."""

from collections.abc import Iterable, Sequence
from typing import Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.generated import Section
from granstudy.support.errors import nearest, unknown_name

Path = Sequence[int | str]
"""Field names, keys and indices, and the names of sections that a field has the choice of."""


def sections_in(kind: Any) -> list[type[Section]]:
    """The sections that a type is made of: itself, the members of a union, the values of a dict."""
    if isinstance(kind, type) and issubclass(kind, Section):
        return [kind]
    return [section for part in get_args(kind) for section in sections_in(part)]


EXPERIMENTS = {
    get_args(section.model_fields["run"].annotation)[0]: section
    for section in sections_in(Experiment)
}
"""The classes of experiments by the kind of their runs."""


def explain(error: ValidationError, file: type[Section]) -> list[str]:
    """The lines for all that is wrong; each names the field, its value and what is allowed."""
    return [line for problem in error.errors() for line in _lines(problem, file)]


def _lines(problem: Any, file: type[Section]) -> list[str]:
    match problem["loc"]:
        case ("experiments", name) if problem["type"].startswith("union_tag"):
            return _without_kind(f"experiments.{name}", problem["input"])
        case ("experiments", name, run, *path) if run in EXPERIMENTS:
            before, section = ["experiments", name], EXPERIMENTS[run]
        case path:
            before, section = [], file
    where = ".".join(str(part) for part in (*before, *path) if not _is_section(part))
    return [": ".join(filter(None, (where, _what(problem, section, path))))]


def _is_section(part: int | str) -> bool:
    """Whether a part of a location names a section out of several, and no field."""
    return any(part == section.__name__ for section in _below(Section))


def _what(problem: Any, section: type[Section], path: Path) -> str:
    """What is wrong at a path of a section."""
    value, kind = problem["input"], problem["type"]
    if kind == "extra_forbidden":
        inside = _walk(section, path[:-1])[1]
        known = [name for each in inside for name in each.model_fields]
        return taken_by(path) or _unknown(path[-1], known)
    field = _walk(section, path)[0]
    if kind == "missing" or (value is None and field is not None and field.is_required()):
        return taken_by(path) or "must be given"
    shown = "" if isinstance(value, dict) else f"value {value!r}: "
    return shown + problem["msg"].removeprefix("Value error, ") + _hint(value, kind)


def _hint(value: object, kind: str) -> str:
    """What to write in place of a number that YAML reads as text."""
    if isinstance(value, str) and kind.startswith(("float", "int")):
        try:
            float(value)
        except ValueError:
            return ""
        return " (YAML reads 1e-3 as text: write 1.0e-3)"
    return ""


def _without_kind(where: str, experiment: dict[str, Any]) -> list[str]:
    """What is wrong with an experiment whose ``run`` is not known: nothing else of it can be checked."""
    if "run" in experiment:
        return [f"{where}.run: {unknown_name('run', experiment['run'], list(EXPERIMENTS))}"]
    known = list(dict.fromkeys(name for each in EXPERIMENTS.values() for name in each.model_fields))
    unknown = [f"{where}.{key}: {_unknown(key, known)}" for key in experiment if key not in known]
    return [*unknown, f"{where}.run: must be given; allowed are {', '.join(EXPERIMENTS)}"]


def _unknown(name: object, known: list[str]) -> str:
    return f"unknown field{nearest(str(name), known)}; allowed are {', '.join(known)}"


def taken_by(path: Path) -> str:
    """Which experiments take the field at a path, and which need it; "" where all or none do.

    Experiments that do not have the section around the field do not count.
    """
    fields = {
        run: _walk(section, path)[0]
        for run, section in EXPERIMENTS.items()
        if _walk(section, path[:-1])[1]
    }
    needed = [run for run, field in fields.items() if field is not None and field.is_required()]
    taken = [run for run, field in fields.items() if field is not None and run not in needed]
    if len(needed) + len(taken) in (0, len(fields)):
        return ""
    if not needed:
        return f"only {_listed(taken)} runs take it"
    annotation = getattr(fields[needed[0]], "annotation", None)
    values = get_args(annotation) if get_origin(annotation) is Literal else ()
    parts = [", ".join(filter(None, (f"{_listed(needed)} runs need it", " or ".join(values))))]
    parts += [f"{_listed(taken)} runs may have it"] if taken else []
    return "; ".join([*parts, "others do not take it"])


def _listed(names: Iterable[str]) -> str:
    return " and ".join(names)


def _walk(section: type[Section], path: Path) -> tuple[FieldInfo | None, list[type[Section]]]:
    """The field at a path of a section, None where there is none, and the sections that it can hold."""
    field, sections = None, [section]
    for part in path:
        chosen = [each for each in sections if each.__name__ == part]
        if chosen or isinstance(part, int):
            sections = chosen or sections
            continue
        field = next(
            (each.model_fields[part] for each in sections if part in each.model_fields), None
        )
        sections = [] if field is None else sections_in(field.annotation)
    return field, sections


def _below(section: type[Section]) -> Iterable[type[Section]]:
    """All classes of sections."""
    for each in section.__subclasses__():
        yield each
        yield from _below(each)
