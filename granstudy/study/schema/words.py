"""The words of study files that a sweep takes: every field of scene, density, solver and time."""

from granstudy.datasets.parameters import PARAMETERS
from granstudy.model.identity import coordinate
from granstudy.study.schema.sections import DENSITY_FIELDS, SceneFields, SolverModel, TimeModel

NOT_SWEPT = ("arguments", "dim", "times")
"""Fields that an experiment has one of."""

SCENE_WORDS = ("scene", *(name for name in SceneFields.model_fields if name not in NOT_SWEPT))
"""Words of a scene: its name, and what can be set of it."""

_FIELDS = [
    name
    for name in (*SCENE_WORDS, *SolverModel.model_fields, *TimeModel.model_fields)
    if name not in NOT_SWEPT
]

COORDINATES = {coordinate(name): name for name in DENSITY_FIELDS}
"""Words of densities by the coordinate that datasets have for them."""

_ORDER = {COORDINATES.get(name, name): place for place, name in enumerate(PARAMETERS)}

SWEPT = tuple(sorted(_FIELDS, key=lambda name: _ORDER.get(name, len(_ORDER))))
"""Words that a study can sweep, in the order of a run's path."""


def place(word: str) -> int:
    """Place of a swept word in a run's path; arguments of own functions come last."""
    return SWEPT.index(word) if word in SWEPT else len(SWEPT)
