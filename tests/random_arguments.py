"""Random arguments: a call of granstudy is made with a few of its arguments replaced by something odd."""

import resource
import signal
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st

import granstudy as gs
from granstudy.model.densities import scene_names

HANGS = 60
"""Seconds after which a call counts as one that never ends."""

ROOM = 2**30
"""Bytes that the process may grow by in a call."""

SAYS = {
    "name": "scene",
    "epsilon": "diffusion",
    "values": "over",
    "word": "over",
    "initial": "scene",
}
"""What messages say in place of a word."""

LONGEST = 1500
"""Characters of a message at most."""


class Enough(BaseException):
    """Raised where the work of a call begins: its arguments were taken."""


def enough(*given, **words):
    raise Enough


@contextmanager
def bounded(room=ROOM, seconds=HANGS):
    """Raise where the process grows by more than ``room`` bytes, or takes longer than so many seconds."""

    def stop(number, frame):
        raise TimeoutError(f"more than {seconds} seconds")

    limits = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + room, limits[1]))
    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
        resource.setrlimit(resource.RLIMIT_AS, limits)


def gaussian(x, y):
    return np.exp(-(x**2 + y**2) / 2) / (2 * np.pi)


def name_of(value: object) -> str:
    """What messages call a value."""
    return getattr(value, "__name__", repr(value))


def of_values(values):
    def density(vx, vy):
        return values(vx + 0.0 * vy)

    return density


def raises(error):
    def fails(*given):
        raise error

    return fails


ANSWERS = [
    lambda x: x,
    lambda x: x * np.nan,
    lambda x: x * 1j,
    lambda x: 0.0 * x,
    lambda x: -np.exp(-(x**2)),
    lambda x: 1e300 * np.exp(-(x**2)),
    lambda x: 1e-300 * np.exp(-(x**2)),
    lambda x: np.exp(-(x**2))[..., :1],
    lambda x: np.exp(-(x**2))[np.newaxis],
    lambda x: np.exp(-(x**2)) > 0.5,
    lambda x: np.exp(-(x**2)).astype(object),
    lambda x: np.exp(-(x**2)).astype(str),
    lambda x: np.exp(-(x**2)).astype(np.float16),
    lambda x: np.exp(-(x**2)).tolist(),
    lambda x: 0.5,
    lambda x: np.float64(0.5),
    lambda x: np.array(0.5),
    lambda x: "text",
    lambda x: None,
    lambda x: [],
    lambda x: {},
    lambda x: lambda y: y,
    lambda x: [1.0, [2.0, 3.0]],
]
"""What a density or a law may return, given the first velocity component or the impact speed."""

FAILURES = [
    ValueError("on purpose"),
    RuntimeError("on purpose"),
    TypeError("on purpose"),
    KeyError("on purpose"),
    ZeroDivisionError("on purpose"),
]

DENSITIES = [
    *map(of_values, ANSWERS),
    *map(raises, FAILURES),
    lambda: 0.5,
    lambda x: x,
    lambda x, y, z, w: x,
    lambda x, y=1.0: np.exp(-(x**2)),
    np.sin,
    abs,
    dict,
]
LAWS = [*ANSWERS, *map(raises, FAILURES), lambda: 0.5, lambda a, b: a, np.sin, abs, dict]

NUMBERS = [
    *(0, 1, 2, 3, 4, 8, 16, 33, -1, 10**5, 10**9, 10**18, 10**400, -(10**400)),
    *(0.0, -0.0, 0.5, 1.0, 2.5, 7.0, -0.5, 1e-300, 1e300, 5e-324, np.inf, -np.inf, np.nan),
    *(np.int64(8), np.int8(3), np.uint8(200), np.float32(0.5), np.float64(0.5), np.float16(6.5)),
    *(np.array(0.5), np.array(8), np.array([0.5]), np.longdouble(0.5), np.bool_(True)),
    *(True, False, 0.5j, 1 + 0j, np.complex128(0.5)),
]
OTHERS = [
    *(None, "", "x", "0.5", "8", "é\n", "x" * 300, "../x", "a.py:f", b"x", "\0"),
    *([], [0.5], (), (1,), (2, 3), (0.0, 1.0), [1, [2]], {}, {"a": 1}, set(), range(3)),
    *(np.array([1.0, np.nan]), np.zeros((2, 2)), np.zeros(0), np.array(["a"]), np.array(None)),
    *(object(), int, ValueError("x"), lambda: 0, ...),
]
WORDS = [
    *("fast", "radial", "direct", "literal", "carleman", "dsmc", "auto", "full", "separate"),
    *("lebedev", "product", "gauss-theta-phi", "design", "single", "double", "gpu", "cpu"),
    *("none", "inversion", "exchange", "reflections", "rescaled", "fixed", "rk3", "dopri54"),
    *(
        "exponential",
        "mass",
        "energy",
        "maxwellian2d",
        "bkw3d",
        "three_gaussians3d",
        "viscoelastic",
    ),
    *(("mass",), ("energy", "mass"), ["mass", "mass"], ("mass", 1), "jacobi", "legendre"),
]


def odd(*more: Any) -> st.SearchStrategy[Any]:
    """Values that a careless or a malicious caller may give, and ``more`` of a field's own."""
    listed = st.sampled_from([*NUMBERS, *OTHERS, *WORDS])
    drawn = st.one_of(st.floats(), st.integers(), st.text(max_size=5))
    own = [st.sampled_from(more)] * (6 if more else 0)
    return st.one_of(listed, listed, drawn, *own)


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
        N = drawn.get("N")  # a sound grid of many points is no mistake, and takes its time
        assume(not (isinstance(N, int | np.integer) and 64 < N < 20_000))
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
        named += [text for value in words.values() if len(text := name_of(value)) > 2]
        assert any(name in said for name in named), f"{kind.__name__} names none of {named}: {said}"
        return said


FAST = {"N": 8, "R": 6.0, "N_rho": 4, "M_cir": 4, "M_sph": 6, "threads": 1}
SCENE = {"name": "maxwellian2d", "e": 0.5}
TIMES = {"t_final": 0.2, "dt": 0.1}

ARRAYS = [
    *(np.zeros((8, 8)), np.full((8, 8), np.nan), np.ones((8, 8), complex), np.ones((8, 7))),
    *(np.ones((8, 8), int), np.ones((8, 8), object), np.full((8, 8), "a"), np.ones((8,) * 3)),
    *(np.full((8, 8), 1e200), np.full((8, 8), -1.0), np.ones((8, 8), "f4"), np.ones((8, 8), bool)),
    *(np.full((8, 8), 1e-200), np.ones((8, 8)).tolist(), np.ones((8, 8), np.longdouble)),
    *(np.ones((8, 8), ">f8"), np.ones((8, 16))[:, ::2], np.full((8, 8), np.inf), np.ones(8)),
]
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
    "precision": ["single"],
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
    called(gs.collision_operator, **SCENE, **FAST | {"method": method})(f)


def swept(values: Any, word: str, **words: Any) -> None:
    """A sweep up to its first run."""
    scene, solver, others = parted({k: v for k, v in words.items() if k != word})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("granstudy.workbench.sweep.compute", enough)
        gs.sweep(scene.pop("name"), gs.Solver(**solver), over={word: values}, **scene, **others)


RADIAL = FAST | {"method": "radial"}
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
    "solver": Call(gs.Solver, FAST, OF_SOLVER),
    "simulate": Call(
        partial(called, gs.simulate, progress=enough), SCENE | RADIAL | TIMES, OF_TIMES
    ),
    "simulate adaptively": Call(
        partial(called, gs.simulate, progress=enough), SCENE | RADIAL | ADAPTIVE, OF_TIMES
    ),
    "simulate a gas": Call(
        partial(called, gs.simulate, progress=enough), SCENE | FAST | TIMES, OF_SCENE
    ),
    "simulate own functions": Call(
        partial(called, gs.simulate, progress=enough), SCENE | FAST | TIMES, FUNCTIONS
    ),
    "simulate own functions by particles": Call(
        partial(called, gs.simulate, progress=enough),
        SCENE | FAST | TIMES | {"method": "dsmc", "particles": 100, "batches": 2},
        FUNCTIONS | OF_TIMES,
    ),
    "simulate with a solver": Call(
        partial(called, gs.simulate, progress=enough), SCENE | FAST | TIMES, OF_SOLVER
    ),
    "operator": Call(partial(called, gs.collision_operator), SCENE | FAST, OF_SOLVER),
    "operator in 3D": Call(
        partial(called, gs.collision_operator), SCENE | FAST | {"name": "bkw3d"}, OF_SOLVER
    ),
    "evaluate": Call(
        evaluated, {"f": np.ones((8, 8)), "method": "fast"}, {"f": ARRAYS}, ("density",)
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
    "choose": Call(partial(called, gs.choose), SCENE | FAST | {"method": "auto"}, OF_SOLVER),
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
        ("over",),
    ),
    "maxwell": Call(gs.maxwell, {"dim": 2}),
    "grid": Call(gs.VelocityGrid, {"dim": 2, "N": 8, "R": 6.0}, {"N": OF_SOLVER["N"]}),
    "radial grid": Call(gs.RadialGrid, {"dim": 2, "N": 8, "R": 6.0}, {"N": OF_SOLVER["N"]}),
}
"""Sound calls, by what is called."""
