"""The words of study files that a sweep takes: every field of scene, density, solver and time."""

from granstudy.datasets.parameters import PARAMETERS
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

COORDINATES = {f"initial_{name}": name for name in DENSITY_FIELDS}
"""Words by the coordinate that datasets have where a moment has the word's own name."""

_ORDER = {COORDINATES.get(name, name): place for place, name in enumerate(PARAMETERS)}

SWEPT = tuple(sorted(_FIELDS, key=lambda name: _ORDER.get(name, len(_ORDER))))
"""Words that a study can sweep, in the order of a run's path."""


def coordinate(word: str) -> str:
    """Name of the coordinate that datasets have for a word of study files."""
    return next((name for name, own in COORDINATES.items() if own == word), word)
