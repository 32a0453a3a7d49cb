"""One line for each thing wrong in a study file: what pydantic found, and what the sections take."""

from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.generated import OLD_WORDS, Section
from granstudy.study.schema.values import TYPE_ERRORS, members, refusal, shown
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
    inside, chosen = [section], False
    for part in path:
        named = [each for each in inside if each.__name__ == part]
        if named:
            inside, chosen = named, True
        elif isinstance(part, int):
            found = found._replace(names=[*found.names, str(part)])
        elif found.field is not None and not chosen and len(members(found.field.annotation)) > 1:
            continue  # the name of a type that the field has the choice of
        else:
            fields = [each.model_fields[part] for each in inside if part in each.model_fields]
            field = fields[0] if fields else None
            found = Place([*found.names, part], inside, field)
            inside, chosen = (sections_in(field.annotation) if field is not None else []), False
    return found


class Mistake(NamedTuple):
    """One thing wrong: at which field, what, and whether it is that the value has another type."""

    names: tuple[str, ...]
    texts: list[str]
    of_type: bool


def explain(error: ValidationError, file: type[Section]) -> list[str]:
    """The lines for all that is wrong; each names the field, its value and what is allowed.

    Of a field that has the choice of several types one line says all of them; none where the mistake lies
    inside of one of them.
    """
    found = [_mistake(problem, file) for problem in error.errors()]
    deeper = {each.names[:size] for each in found for size in range(len(each.names))}
    kept = [each for each in found if not (each.of_type and each.names in deeper)]
    return list(dict.fromkeys(line for each in kept for line in _lines(each)))


def _lines(mistake: Mistake) -> list[str]:
    where = ".".join(mistake.names)
    return [
        f"{where}{text}" if text.startswith(".") else ": ".join(filter(None, (where, text)))
        for text in mistake.texts
    ]


def _mistake(problem: Any, file: type[Section]) -> Mistake:
    kind, value = problem["type"], problem["input"]
    match problem["loc"]:
        case ("experiments", name) if not isinstance(value, dict):
            what = f"value {shown(value)}: must be a section with run: {', '.join(EXPERIMENTS)}"
            return Mistake(("experiments", str(name)), [what], False)
        case ("experiments", name) if kind.startswith("union_tag"):
            return Mistake((), _without_kind(f"experiments.{name}", value), False)
        case ("experiments", name, run, *path) if run in EXPERIMENTS:
            found = place(EXPERIMENTS[run], path)
            names, takers = ["experiments", name, *found.names], taken_by(found.names)
        case path:
            found = place(file, path)
            names, takers = found.names, ""
    is_missing = value is None and found.field is not None and found.field.is_required()
    is_of_type = False
    if kind == "extra_forbidden":
        known = [name for section in found.around for name in section.model_fields]
        what = takers or _unknown(found.names[-1], known)
    elif kind == "missing" or is_missing:
        what = takers or "must be given"
    else:
        is_of_type = kind.endswith(TYPE_ERRORS)
        what = refusal(problem, found.field and found.field.annotation)
    return Mistake(tuple(map(str, names)), what.splitlines(), is_of_type)


def _without_kind(where: str, experiment: Any) -> list[str]:
    """What is wrong with an experiment whose ``run`` is not known: nothing else of it can be checked."""
    if "run" in experiment:
        return [f"{where}.run: {unknown_name('run', experiment['run'], list(EXPERIMENTS))}"]
    known = list(dict.fromkeys(name for each in EXPERIMENTS.values() for name in each.model_fields))
    unknown = [f"{where}.{key}: {_unknown(key, known)}" for key in experiment if key not in known]
    return [*unknown, f"{where}.run: must be given; allowed are {', '.join(EXPERIMENTS)}"]


def _unknown(name: object, known: list[str]) -> str:
    old = [word for word, new in OLD_WORDS.items() if new in known]
    close = nearest(str(name), [*known, *old])
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
