"""Random arguments: a call of granstudy is made with a few of its arguments replaced by something odd."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bounded import bounded
from hypothesis import assume
from hypothesis import strategies as st
from odd_values import ARRAYS, DENSITIES, LAWS, gaussian, odd

import granstudy as gs
from granstudy.model.densities import scene_names

SAYS = {
    "name": "scene",
    "epsilon": "diffusion",
    "values": "over",
    "word": "over",
    "initial": "scene",
    "temperature": "density",
}
"""What messages say in place of a word."""

LONGEST = 1500
"""Characters of a message at most."""


class Enough(BaseException):
    """Raised where the work of a call begins: its arguments were taken."""


def enough(*given, **words):
    raise Enough


def name_of(value: object) -> str:
    """What messages call a value."""
    return value if isinstance(value, str) else getattr(value, "__name__", repr(value)).strip("<>")


@dataclass(frozen=True)
class Call:
    """A call of granstudy that is sound.

    Attributes
    ----------
    make : callable
        What is called with words.
    sound : dict
        The words and their values.
    more : dict
        Values worth trying, beside `odd`, by word; such a word need not be in ``sound``.
    names : tuple of str
        What messages may name beside the words.
    """

    make: Callable[..., Any]
    sound: dict[str, Any]
    more: dict[str, list[Any]] = field(default_factory=dict)
    names: tuple[str, ...] = ()

    def drawn(self, draw: Callable[[st.SearchStrategy[Any]], Any]) -> dict[str, Any]:
        """Words to replace, with their values."""
        every = sorted({*self.sound, *self.more})
        words = draw(st.lists(st.sampled_from(every), min_size=1, max_size=2, unique=True))
        drawn = {word: draw(odd(*self.more.get(word, ()))) for word in words}
        for word in ("N", "N_rho"):  # sound sizes are no mistake, and take their time
            size = drawn.get(word)
            assume(not (isinstance(size, int | np.integer) and 64 < size < 20_000))
        return drawn

    def verdict(self, words: dict[str, Any]) -> str:
        """ "" where the call takes the words, else what it says.

        Raises
        ------
        AssertionError
            If it raises another error than a plain one of ours, or one that names none of the words.
        """
        with bounded(), warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            try:
                self.make(**{**self.sound, **words})
            except Enough:
                return ""
            except (ValueError, TypeError) as error:
                said, kind = str(error), type(error)
            else:
                return ""
        ours = kind in (ValueError, TypeError) or kind.__module__.startswith("granstudy.")
        assert ours, f"{kind}: {said}"
        assert len(said) < LONGEST, said
        named = [*words, *self.names, *(SAYS[word] for word in words if word in SAYS)]
        named += [text for value in words.values() if (text := name_of(value))]
        assert any(name in said for name in named), f"{kind.__name__} names none of {named}: {said}"
        return said


GRID = {"N": 8, "R": 6.0, "N_rho": 4, "M_cir": 4, "M_sph": 6, "threads": 1}
LITERAL = GRID | {"method": "literal"}  # of which nothing has to be compiled
SCENE = {"name": "maxwellian2d", "e": 0.5}
TIMES = {"t_final": 0.2, "dt": 0.1}

OF_SCENE = {
    "name": [*scene_names(), *DENSITIES],
    "e": [0.0, 0.3, 1.0],
    "exponent": [0.0, 0.5, 1.0],
    "strength": [1e-10, 1e10],
    "diffusion": [0.0, 0.1],
    "symmetry": ["full", "exchange", "x", gs.Symmetry.named(3, "full")],
    "dim": [2, 3],
    "kernel": [gs.VHS(1.0, 0.2)],
    "restitution": [gs.Viscoelastic(0.1), *LAWS],
    "temperature": [1e-6, 0.5, 100.0],
    "velocity": [(0.0, 1.0), (1, 2, 3), (np.nan, 0.0), np.array([0.5, 0.5])],
    "A": [0.1],
    "tail": [12.0],
    "epsilon": [0.1],
    "beside": ["/", Path.cwd()],
}
OF_SOLVER = {
    "N": [2, 6, 8, 10, 64, 20_000, 10**6],
    "R": [1e-3, 3.0, 20.0, 1e3],
    "N_rho": [1, 2, 8, 300, 10**4, 10**7],
    "M_cir": [1, 2, 3, 10**4, 10**8],
    "M_sph": [2, 6, 7, 32, 10**5, (4, 4), (10**5, 10**5)],
    "method": ["fast", "radial", "direct", "literal", "carleman", "dsmc", "auto"],
    "rtol": [1e-1, 1e-3, 1e-12, 1e-17],
    "particles": [20, 200, 1000, 10**12, 10**15],
    "batches": [2, 10, 10**6],
    "seed": [0, 10**30],
    "sphere_rule": ["lebedev", "product"],
    "radial_rule": ["jacobi"],
    "variant": ["full"],
    "circular": [],
    "dealias": [],
    "precision": [],  # single is another code to compile
    "device": ["gpu"],
    "threads": [1, 2, 10**6],
}
OF_TIMES = {
    "t_final": [0.1, 1e-12, 1e12],
    "dt": [0.05, 0.2, 1e-12],
    "time_rtol": [1e-3, 1e-14],
    "times": [[0.1], [0.1, 0.05], [0.1, 0.3], [0.0, 0.1], ["a"], [[0.1]], np.array([0.1, 0.2])],
    "frame": ["rescaled"],
    "scheme": ["rk3", "dopri54", "exponential"],
    "conserve": [("mass",), ("mass", "momentum", "energy"), {"mass"}, ["energy", "energy"]],
    "save_every": [1, 2],
}
OF_STATES = {"tolerance": [1e-9, 1e-20], "max_iterations": [1, 2]}
VALUES = [[0.3, 0.5], [0.5, 0.5], [0.5, None], [1.5], ["a", 1], np.array([0.1]), np.zeros((2, 2))]
VALUES += [{"start": 0.0, "stop": 1.0, "count": 3}, {"start": 0.0}, [[0.1], [0.2]], [10**9]]


def parted(words: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """The words of the scene, of the solver, and the others."""
    if "restitution" in words:
        words.pop("e", None)
    scene = {k: words.pop(k) for k in OF_SCENE if k in words}
    solver = {k: words.pop(k) for k in OF_SOLVER if k in words}
    return scene, solver, words


def called(function: Callable[..., Any], **words: Any) -> Any:
    """A function of scene and solver, called with words of both and words of its own."""
    scene, solver, others = parted(words)
    return function(gs.load_scene(**scene), gs.Solver(**solver), **others)


def scene_of(**words: Any) -> gs.Scene:
    return gs.load_scene(**parted(words)[0])


def evaluated(f: Any, method: str) -> None:
    """An operator called with a density."""
    called(gs.collision_operator, **SCENE, **GRID | {"method": method})(f)


def swept(values: Any, word: str, **words: Any) -> None:
    """A sweep up to its first run."""
    word = word if isinstance(word, str | float | int) else "e"
    scene, solver, others = parted({k: v for k, v in words.items() if k != word})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("granstudy.workbench.sweep.compute", enough)
        gs.sweep(scene.pop("name"), gs.Solver(**solver), over={word: values}, **scene, **others)


RADIAL = GRID | {"method": "radial"}
ADAPTIVE = {"t_final": 0.2, "time_rtol": 1e-3}
FUNCTIONS = {"name": DENSITIES, "restitution": LAWS}

CALLS = {
    "kernel": Call(gs.VHS, {"exponent": 1.0, "strength": 0.2}),
    "law": Call(gs.Viscoelastic, {"A": 0.1}),
    "scene": Call(
        gs.Scene,
        {"dim": 2, "initial": gaussian, "kernel": gs.VHS(1.0, 0.2), "restitution": 0.5}
        | {"diffusion": 0.0, "symmetry": None},
        {
            "initial": OF_SCENE["name"],
            **{k: OF_SCENE[k] for k in ("restitution", "symmetry", "dim")},
        },
    ),
    "load_scene": Call(scene_of, SCENE, OF_SCENE),
    "solver": Call(gs.Solver, GRID, OF_SOLVER),
    "simulate": Call(
        partial(called, gs.simulate, progress=enough), SCENE | RADIAL | TIMES, OF_TIMES
    ),
    "simulate adaptively": Call(
        partial(called, gs.simulate, progress=enough), SCENE | RADIAL | ADAPTIVE, OF_TIMES
    ),
    "simulate a gas": Call(
        partial(called, gs.simulate, progress=enough), SCENE | LITERAL | TIMES, OF_SCENE
    ),
    "simulate own functions": Call(
        partial(called, gs.simulate, progress=enough), SCENE | LITERAL | TIMES, FUNCTIONS
    ),
    "simulate own functions by particles": Call(
        partial(called, gs.simulate, progress=enough),
        SCENE | LITERAL | TIMES | {"method": "dsmc", "particles": 100, "batches": 2},
        FUNCTIONS | OF_TIMES,
    ),
    "simulate with a solver": Call(
        partial(called, gs.simulate, progress=enough), SCENE | LITERAL | TIMES, OF_SOLVER
    ),
    "operator": Call(partial(called, gs.collision_operator), SCENE | GRID, OF_SOLVER),
    "operator in 3D": Call(
        partial(called, gs.collision_operator), SCENE | GRID | {"name": "bkw3d"}, OF_SOLVER
    ),
    "evaluate": Call(
        evaluated, {"f": np.ones((8, 8)), "method": "literal"}, {"f": ARRAYS}, ("density",)
    ),
    "cooling state": Call(
        partial(called, gs.cooling_state, progress=enough),
        SCENE | RADIAL | {"diffusion": 0.0},
        OF_STATES | OF_SCENE,
    ),
    "heated state": Call(
        partial(called, gs.heated_state, progress=enough),
        SCENE | RADIAL | {"diffusion": 0.1},
        OF_STATES | OF_SOLVER,
    ),
    "choose": Call(partial(called, gs.choose), SCENE | GRID | {"method": "auto"}, OF_SOLVER),
    "plan": Call(partial(called, gs.plan), SCENE | RADIAL | TIMES, OF_TIMES | OF_SOLVER),
    "fit_solver": Call(
        lambda rtol, **words: gs.fit_solver(scene_of(**words), rtol),
        SCENE | {"rtol": 1e-2},
        {"rtol": [1e-3, 1e-12]} | OF_SCENE,
    ),
    "sweep": Call(
        swept,
        SCENE | RADIAL | TIMES | {"values": [0.3, 0.5], "word": "e"},
        {"values": VALUES, "word": [*OF_SCENE, *OF_SOLVER, *OF_TIMES], "state": ["cooling"]}
        | {"refine": [{"N": [8, 12]}, {"N": 8}, {"x": [1]}], "workers": [1], "name": ["x"]},
        ("over", "e=", "unknown field"),
    ),
    "maxwell": Call(gs.maxwell, {"dim": 2}),
    "grid": Call(gs.VelocityGrid, {"dim": 2, "N": 8, "R": 6.0}, {"N": OF_SOLVER["N"]}),
    "radial grid": Call(gs.RadialGrid, {"dim": 2, "N": 8, "R": 6.0}, {"N": OF_SOLVER["N"]}),
}
"""Sound calls, by what is called."""
