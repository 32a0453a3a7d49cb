"""Random mistakes in study files: a shipped study, or one with code of its own, a few things changed."""

import copy
import random
from contextlib import suppress
from pathlib import Path

import yaml

from granstudy.study.schema.words import SWEPT

SHIPPED = Path(__file__).parents[1] / "studies"

OWN_CODE = """
import numpy as np

def anisotropic(x, y, ratio=2.0, hot=1.0):
    return np.exp(-x**2 / (2 * hot) - y**2 / (2 * hot * ratio)) / (2 * np.pi * hot * np.sqrt(ratio))

def softening(v, drop=0.1):
    return 1.0 - drop * v / (1.0 + v)

def fails(x, y, ratio=2.0):
    raise RuntimeError("on purpose")

def wrong(x, y):
    return "text"

number = 5
"""

OWN_STUDY = """
title: own
experiments:
  gas:
    title: "A gas of one's own"
    run: evolution
    scene: {name: my_gas.py:anisotropic, e: 0.5, hot: 1.5}
    solver: {N: 16, R: 7.0, N_rho: 8, M_cir: 8}
    time: {t_final: 1.0, dt: 0.1}
    sweep:
      - {ratio: {start: 1.0, stop: 3.0, count: 3}, variant: [full]}
    table: {quantity: a2}
  law:
    title: "A law of one's own"
    run: evolution
    scene: {name: maxwellian2d, restitution: my_gas.py:softening, exponent: 1.0, diffusion: 0.0}
    solver: {R: 7.0, N_rho: 8, M_cir: 8}
    time: {t_final: 1.0, time_rtol: 1.0e-4}
    refine: {N: [8, 12, 16]}
    sweep:
      - {drop: [0.1, 0.2], temperature: [1.0, 2.0]}
    table: {quantity: temperature}
    figure: {kind: cooling}
"""

ODD = [
    *(None, True, False, 0, -1, 1, 2, 3, 8, 15, 16, 64, 0.0, -0.5, 0.5, 1.0, 1.5, 7.0, 1e-300, 1e300),
    *(1e-6, 10**5, 10**9, 10**18, -(10**18), "", " ", "x", "a/b", "../x", "{x}", "$\\foo$", "1e-3", "no"),
    *("x" * 300, "é", "a\nb", "\t", "'", "auto", "literal", "direct", "fast", "radial", "carleman", "dsmc"),
    *("design", "gauss-theta-phi", "nodes.txt", "my_gas.py", "jacobi", "full", "separate", "single", "gpu"),
    *("my_gas.py:anisotropic", "my_gas.py:softening", "my_gas.py:fails", "my_gas.py:wrong"),
    *("my_gas.py:number", "my_gas.py:nothing", "nowhere.py:f", "my_gas.py:", ":", ".py:f"),
    *("bkw2d", "bkw3d", "two_beams3d", "power_law3d", "maxwellian2d", "viscoelastic", "none", "inversion"),
    *("evolution", "collision", "benchmark", "state", "cooling", "heated", "rescaled", "exponential", "rk3"),
    *("temperature", "a2", "seconds", "error", "collision_error", "temperature_error", "table1", "figure4"),
    *("order", "haff", "growth", "slope", "convergence", "front", "states", "gallery", "N", "e", "dt", "R"),
    *([], [1], [0.5], ["x"], [1, 2], [2, 3], [0.1, 0.2, 0.3], [[1]], [[2, 3], [3, 4]], [None], [{}], {}),
    *({"start": 0.1, "stop": 0.9, "count": 3}, {"start": 0, "stop": 10**9, "step": 1}, {"x": 1}),
    *({"start": 1.0, "stop": 1e300, "count": 4, "spacing": "log"}, {"viscoelastic": 0.1}),
    *({"law": "maxwell"}, {"first": 0.1, "per_decade": 3}, {"first": 1e-300, "per_decade": 10**7}),
    *({"N": [8, 16]}, {"N": [16, 8]}, {"R": [5.0, 7.0]}, {"name": "bkw2d"}, {"method": "direct"}),
    *({"solver": {"N": 8, "R": 7.0, "method": "radial"}}, {"start": 0.5}, {"title": "t"}),
]  # fmt: skip
"""Values of every kind, most of them wrong wherever they stand."""

NAMES = [
    "../x",
    "a/b",
    "a\\b",
    "{x}",
    "",
    "reference",
    ".hidden",
    "a b",
    "map",
    "x" * 300,
    "é",
    "ok",
    "0",
]
"""Names of experiments."""

WORDS = [
    *(*SWEPT, "title", "run", "state", "scene", "solver", "time", "truth", "reference", "refine", "sweep"),
    *("table", "fit", "figure", "threads", "timing", "quantity", "paper", "average", "beside", "kind", "x"),
    *("law", "times", "first", "last", "per_decade", "start", "stop", "count", "step", "spacing", "epsilon"),
    *("baseline", "rounds", "arguments", "dim", "name", "ratio", "drop", "e", "N", "dt"),
]  # fmt: skip


def experiments():
    """Every shipped experiment, and those with code of their own: name, section, and the whole study."""
    texts = [path.read_text() for path in sorted(SHIPPED.glob("*.yaml"))]
    studies = [yaml.safe_load(text) for text in (*texts, OWN_STUDY, OWN_STUDY, OWN_STUDY)]
    return [(name, study) for study in studies for name in study["experiments"]]


def mutated(seed):
    """The text of a study of one experiment, and those beside it, with one to four things in it changed."""
    chance = random.Random(seed)
    name, study = chance.choice(experiments())
    section = study["experiments"][name]
    beside = [
        *section.get("table", {}).get("beside", []),
        *section.get("figure", {}).get("beside", []),
    ]
    kept = {each: study["experiments"][each] for each in (name, *beside)}
    study = copy.deepcopy({"title": study["title"], "experiments": kept})
    for _ in range(chance.choice((1, 1, 1, 2, 3, 4))):
        with suppress(IndexError):  # where little is left of the study
            chance.choice(CHANGES)(chance, study)
    text = yaml.dump(study, Dumper=_Dumper, sort_keys=False, allow_unicode=True)
    return _scrambled(chance, text) if chance.random() < 0.1 else text


class _Dumper(yaml.SafeDumper):
    """Writes aliases out."""

    def ignore_aliases(self, data):
        return True


def _places(node, found=None):
    """All containers of a study with the keys of what they hold."""
    found = [] if found is None else found
    items = (
        node.items()
        if isinstance(node, dict)
        else enumerate(node)
        if isinstance(node, list)
        else ()
    )
    for key, value in items:
        found.append((node, key))
        _places(value, found)
    return found


def _replace(chance, study):
    container, key = chance.choice(_places(study))
    container[key] = copy.deepcopy(chance.choice(ODD))


def _alike(chance, study):
    """Another value for a field: one that it has elsewhere, or an odd one of its type."""
    places = [(node, key) for node, key in _places(study) if isinstance(node, dict)]
    container, key = chance.choice([place for place in places if place[1] in CORPUS] or places)
    value, known = container[key], CORPUS.get(key, [])
    types = {type(each) for each in known} | {type(value)}
    odd = [each for each in ODD if type(each) in types]
    inner = value if isinstance(value, list) and value and chance.random() < 0.5 else None
    new = copy.deepcopy(chance.choice(known if known and chance.random() < 0.6 else odd or ODD))
    if inner is not None and not isinstance(new, list):
        inner[chance.randrange(len(inner))] = new
    else:
        container[key] = new


def _give(chance, study):
    """A field that its section has elsewhere."""
    places = [(node, key) for node, key in _places(study) if isinstance(node[key], dict)]
    container, key = chance.choice(places)
    word, value = chance.choice(FIELDS.get(key, [("title", "t")]))
    container[key][word] = copy.deepcopy(value)


def _sweep(chance, study):
    """A word of the sweep, with a value that it has elsewhere."""
    words = [word for word in SWEPT if word in CORPUS]
    found = study.get("experiments")
    for section in found.values() if isinstance(found, dict) else ():
        blocks = section.get("sweep") if isinstance(section, dict) else None
        word = chance.choice(words)
        for block in blocks if isinstance(blocks, list) else ():
            if isinstance(block, dict):
                value = copy.deepcopy(chance.choice(CORPUS[word]))
                block[word] = value if isinstance(value, list) else [value]


def _remove(chance, study):
    container, key = chance.choice(_places(study))
    del container[key]


def _rename(chance, study):
    container, key = chance.choice(
        [place for place in _places(study) if isinstance(place[0], dict)]
    )
    name = str(key)
    cut = chance.randrange(len(name) + 1)
    new = chance.choice(
        (name[:cut] + name[cut + 1 :], name + "x", name.upper(), chance.choice(WORDS))
    )
    container[new] = container.pop(key)


def _add(chance, study):
    sections = [node for node in _sections(study) if isinstance(node, dict)]
    chance.choice(sections)[chance.choice(WORDS)] = copy.deepcopy(chance.choice(ODD))


def _wrap(chance, study):
    container, key = chance.choice(_places(study))
    value = container[key]
    container[key] = (
        value[0] if isinstance(value, list) and value else [value, copy.deepcopy(value)]
    )


def _swap(chance, study):
    (one, i), (other, j) = chance.choice(_places(study)), chance.choice(_places(study))
    mine, its = copy.deepcopy(one[i]), copy.deepcopy(other[j])
    one[i] = its
    if j in other if isinstance(other, dict) else j < len(other):
        other[j] = mine


def _another(chance, study):
    found = study.get("experiments")
    if isinstance(found, dict) and found:
        found[chance.choice(NAMES)] = copy.deepcopy(chance.choice(list(found.values())))


def _sections(node):
    if isinstance(node, dict | list):
        yield node
        for value in node.values() if isinstance(node, dict) else node:
            yield from _sections(value)


CHANGES = (
    *(
        _alike,
        _alike,
        _alike,
        _alike,
        _alike,
        _alike,
        _alike,
        _alike,
        _give,
        _give,
        _give,
        _sweep,
        _sweep,
    ),
    *(_replace, _remove, _remove, _rename, _add, _wrap, _swap, _another),
)


def _corpus():
    """Values of every word in all studies, and fields of every section."""
    values, fields = {}, {}
    for _, study in experiments():
        for container, key in _places(study):
            if isinstance(container, dict):
                values.setdefault(key, []).append(container[key])
                if isinstance(container[key], dict):
                    fields.setdefault(key, []).extend(container[key].items())
    return values, fields


CORPUS, FIELDS = _corpus()
"""Values of every word in all studies, and fields of every section."""


def _scrambled(chance, text):
    """A text with some characters or lines changed."""
    place = chance.randrange(len(text))
    match chance.randrange(4):
        case 0:
            return (
                text[:place] + chance.choice("{}[]:,&*!|>'\"%@`#-?\t\n\x00é\ud800") + text[place:]
            )
        case 1:
            return text[:place] + text[place + chance.randrange(1, 20) :]
        case 2:
            lines = text.splitlines()
            lines.insert(chance.randrange(len(lines)), chance.choice(lines))
            return "\n".join(lines)
        case _:
            return text[:place]
