"""One line for each thing wrong in a study file: what pydantic found, and what the sections take."""

from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.generated import OLD_WORDS, Section
from granstudy.support.errors import nearest, unknown_name


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


class Place(NamedTuple):
    """What lies at a path of a section.

    Attributes
    ----------
    names : list of str
        Fields, keys and indices on the way, without the names of sections that a field has the choice of.
    around : list of sections
        Those that the last field stands in; none where a field on the way is unknown.
    field : FieldInfo or None
        The last field, None where it is unknown.
    """

    names: list[str]
    around: list[type[Section]]
    field: FieldInfo | None


def place(section: type[Section], path: Sequence[int | str]) -> Place:
    """Follow a path of fields, keys and indices into a section."""
    found = Place([], [], None)
    inside = [section]
    for part in path:
        chosen = [each for each in inside if each.__name__ == part]
        if chosen:
            inside = chosen
        elif isinstance(part, int):
            found = found._replace(names=[*found.names, str(part)])
        else:
            fields = [each.model_fields[part] for each in inside if part in each.model_fields]
            field = fields[0] if fields else None
            found = Place([*found.names, part], inside, field)
            inside = sections_in(field.annotation) if field is not None else []
    return found


def explain(error: ValidationError, file: type[Section]) -> list[str]:
    """The lines for all that is wrong; each names the field, its value and what is allowed."""
    return [line for problem in error.errors() for line in _lines(problem, file)]


def _lines(problem: Any, file: type[Section]) -> list[str]:
    kind, value = problem["type"], problem["input"]
    match problem["loc"]:
        case ("experiments", name) if kind.startswith("union_tag"):
            return _without_kind(f"experiments.{name}", value)
        case ("experiments", name, run, *path) if run in EXPERIMENTS:
            found = place(EXPERIMENTS[run], path)
            names, takers = ["experiments", name, *found.names], taken_by(found.names)
        case path:
            found = place(file, path)
            names, takers = found.names, ""
    is_missing = value is None and found.field is not None and found.field.is_required()
    if kind == "extra_forbidden":
        known = [name for section in found.around for name in section.model_fields]
        what = takers or _unknown(found.names[-1], known)
    elif kind == "missing" or is_missing:
        what = takers or "must be given"
    else:
        what = _refused(problem)
    return [": ".join(filter(None, (".".join(names), what)))]


def _refused(problem: Any) -> str:
    """Why a value is refused, and what to write in place of a number that YAML reads as text."""
    value, message = problem["input"], problem["msg"].removeprefix("Value error, ")
    shown = "" if isinstance(value, dict) else f"value {value!r}: "
    hint = ""
    if isinstance(value, str) and problem["type"].startswith(("float", "int")):
        try:
            float(value)
            hint = " (YAML reads 1e-3 as text: write 1.0e-3)"
        except ValueError:
            pass
    return f"{shown}{message}{hint}"


def _without_kind(where: str, experiment: dict[str, Any]) -> list[str]:
    """What is wrong with an experiment whose ``run`` is not known: nothing else of it can be checked."""
    if "run" in experiment:
        return [f"{where}.run: {unknown_name('run', experiment['run'], list(EXPERIMENTS))}"]
    known = list(dict.fromkeys(name for each in EXPERIMENTS.values() for name in each.model_fields))
    unknown = [f"{where}.{key}: {_unknown(key, known)}" for key in experiment if key not in known]
    return [*unknown, f"{where}.run: must be given; allowed are {', '.join(EXPERIMENTS)}"]


def _unknown(name: object, known: list[str]) -> str:
    close = nearest(str(name), [*known, *OLD_WORDS])
    return f"unknown field{close}; allowed are {', '.join(known)}"


def taken_by(path: Sequence[str]) -> str:
    """Which experiments take the field at a path, and which need it; "" where all or none do.

    Experiments that do not have the section around the field do not count.
    """
    found = {run: place(section, path) for run, section in EXPERIMENTS.items()}
    fields = {run: there.field for run, there in found.items() if there.around}
    needed = [run for run, field in fields.items() if field is not None and field.is_required()]
    taken = [run for run, field in fields.items() if field is not None and run not in needed]
    if len(needed) + len(taken) in (0, len(fields)):
        return ""
    if not needed:
        return f"only {_listed(taken)} runs take it"
    field = fields[needed[0]]
    values = get_args(field.annotation) if field and get_origin(field.annotation) is Literal else ()
    parts = [", ".join(filter(None, (f"{_listed(needed)} runs need it", " or ".join(values))))]
    parts += [f"{_listed(taken)} runs may have it"] if taken else []
    return "; ".join([*parts, "others do not take it"])


def _listed(names: Iterable[str]) -> str:
    return " and ".join(names)
