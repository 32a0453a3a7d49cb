"""Scenes by name, or by a function of the user, with any of their words set."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from granstudy.model.densities import density_parameters, named_density
from granstudy.model.kernel import VHS, maxwell
from granstudy.model.own_functions import own_density, own_law
from granstudy.model.restitution import LAWS, Restitution, law_parameters
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.checks import is_real
from granstudy.support.errors import nearest, unknown_name
from granstudy.support.own_code.code import name_of
from granstudy.support.own_code.load import is_reference, load_function
from granstudy.support.own_code.signature import arguments_of
from granstudy.velocity.space import check_dim

SCENE_WORDS = (
    *("e", "restitution", "exponent", "strength", "kernel", "diffusion", "epsilon", "symmetry"),
    "dim",
)
"""Words that every scene takes; ``dim`` is for densities of any dimension."""

OLD_WORDS = {"epsilon": "diffusion"}
"""Words of earlier versions, and what to write."""

TIME_WORDS = (
    *("t_final", "dt", "time_rtol", "times", "frame", "scheme", "conserve", "save_every"),
)
"""Words of runs through time."""

RESERVED = frozenset(
    ("name", "beside", *SCENE_WORDS, *TIME_WORDS, *(field.name for field in fields(Solver)))
)
"""Words that no argument of a user's function can have: a study file could not tell them apart."""

ONE_OF = (
    ("e", "restitution"),
    ("kernel", "exponent"),
    ("kernel", "strength"),
    ("diffusion", "epsilon"),
)
"""Words that say the same, of which a scene takes one."""

Function = Callable[..., Any]


def load_scene(
    name: str | Function, *, beside: str | Path | None = None, **overrides: Any
) -> Scene:
    """A scene by its name, or by a density of one's own, with any word set.

    The defaults are the paper's: Maxwell molecules of unit cross-section, e = 1, ε = 10⁻⁶.

    Parameters
    ----------
    name : str or callable
        A name out of `granstudy.model.densities.INITIAL_DENSITIES`; a reference to a function in a file,
        ``my_gas.py:anisotropic``; or the function itself (`granstudy.model.own_functions.own_density`).
    beside : str or Path, optional
        Folder that references start from; by default the working folder.
    overrides
        Words of the scene:

        ===================  ==================================================================
        ``e``                constant restitution
        ``restitution``      a constant, a function, a reference to one, or the name of a law
        ``exponent``         λ of the kernel
        ``strength``         C_λ of the kernel
        ``kernel``           a `granstudy.VHS`, in place of both
        ``diffusion``        ε
        ``symmetry``         as of `granstudy.Scene`
        ``dim``              for functions of any number of velocity components
        ===================  ==================================================================

        Arguments of the density, and of the law of restitution:

        ================  =================================
        ``maxwellian``    ``temperature``, ``velocity``
        ``uniform_ball``  ``temperature``
        ``power_law``     ``temperature``, ``tail``
        ``two_beams``     ``temperature``, ``separation``
        ``viscoelastic``  ``A``
        own functions     their own
        ================  =================================

    Raises
    ------
    ValueError
        For an unknown name or word, two words that say the same, an argument that density and law both take,
        or a value that its field does not allow.
    """
    folder = Path.cwd() if beside is None else beside
    words = {key: value for key, value in overrides.items() if key in SCENE_WORDS}
    own = {key: value for key, value in overrides.items() if key not in SCENE_WORDS}
    _check_words(words)
    if not (isinstance(name, str) or callable(name)):
        raise ValueError(
            f"name={name!r}: must be the name of a scene, a reference to a density, or a density"
        )
    if not isinstance(folder, str | Path):
        raise ValueError(f"beside={beside!r}: must be a folder, a text or a Path")
    density: str | Function = name
    if isinstance(name, str) and is_reference(name):
        density = load_function(name, folder)
    law = words.get("restitution")
    if isinstance(law, str) and is_reference(law):
        law = load_function(law, folder)
    elif isinstance(law, str) and law not in LAWS:
        raise unknown_name("restitution", law, [*LAWS, "my_file.py:my_law"])
    for_density, for_law = _shared_out(own, density, law)
    base = _base(density, for_density, words.get("dim"))
    return Scene(
        base.dim,
        base.initial,
        kernel=_kernel(base.kernel, words),
        restitution=_restitution(base.restitution, law, for_law, words),
        diffusion=words.get("diffusion", words.get("epsilon", base.diffusion)),
        symmetry=words.get("symmetry", base.symmetry),
    )


def density_arguments(density: str | Function) -> list[str]:
    """Names of the arguments that a density takes, given by its name or as a function."""
    if isinstance(density, str):
        named_density(density)
        return [field.name for field in density_parameters(density)]
    return _checked(density)


def law_arguments(law: Any) -> list[str]:
    """Names of the arguments that a law of restitution takes; none of a constant."""
    if isinstance(law, str):
        return law_parameters(law)
    return _checked(law) if callable(law) else []


def _checked(function: Function) -> list[str]:
    """Names of the arguments of a user's function, none of which may be a word of something else."""
    try:
        names = list(arguments_of(function))
    except ValueError:  # of a function without a signature no argument can be set
        return []
    for name in names:
        if name in RESERVED:
            raise ValueError(
                f"{name_of(function)}: its argument {name!r} is a word of scenes, solvers or times; give it "
                "another name"
            )
    return names


def _check_words(words: Mapping[str, Any]) -> None:
    for one, other in ONE_OF:
        if one in words and other in words:
            raise ValueError(
                f"{one}={words[one]!r}, {other}={words[other]!r}: both say the same; give one"
            )
    for old, new in OLD_WORDS.items():
        if old in words:
            warnings.warn(
                f"{old}: is called {new} now; write {new}={words[old]!r}",
                DeprecationWarning,
                stacklevel=3,
            )
    if words.get("dim") is not None:
        check_dim(words["dim"])
    e = words.get("e", 1.0)
    if not is_real(e) or not 0.0 <= e <= 1.0:
        raise ValueError(f"e={e!r}: must be a number between 0 and 1")


def _shared_out(
    own: Mapping[str, Any], density: str | Function, law: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Arguments of the density, and of the law."""
    of_density, of_law = density_arguments(density), law_arguments(law)
    for key in own:
        if key in of_density and key in of_law:
            raise ValueError(
                f"{key}={own[key]!r}: the density {_name(density)} and the restitution {_name(law)} both "
                "have such an argument; give one of them another name"
            )
        if key not in of_density and key not in of_law:
            allowed = sorted({*SCENE_WORDS, *of_density, *of_law} - OLD_WORDS.keys())
            raise ValueError(
                f"unknown field of scene {_name(density)!r} {key!r}{nearest(key, allowed)}: allowed are "
                f"{', '.join(allowed)}"
            )
    return (
        {key: value for key, value in own.items() if key in of_density},
        {key: value for key, value in own.items() if key in of_law},
    )


def _name(function: Any) -> str:
    return function if isinstance(function, str) else name_of(function)


def _base(density: str | Function, arguments: Mapping[str, Any], dim: int | None) -> Scene:
    """The scene of a density without words: the paper's, or the one that the user's function makes."""
    if isinstance(density, str):
        initial: Any = named_density(density)(**arguments)
        if dim not in (None, initial.dim):
            raise ValueError(f"dim={dim!r}: {density} has dim {initial.dim}; leave dim out")
    else:
        initial = own_density(density, arguments, dim)
        made = initial.scene
        if isinstance(made, Scene):
            return Scene(
                made.dim, initial, made.kernel, made.restitution, made.diffusion, made.symmetry
            )
    return Scene(initial.dim, initial, maxwell(initial.dim), diffusion=1e-6)


def _kernel(base: VHS, words: Mapping[str, Any]) -> VHS:
    if "kernel" in words:
        kernel: VHS = words["kernel"]
        return kernel
    return VHS(words.get("exponent", base.exponent), words.get("strength", base.strength))


def _restitution(
    base: Restitution, law: Any, arguments: Mapping[str, Any], words: Mapping[str, Any]
) -> Restitution:
    if "e" in words:
        e: float = words["e"]
        return e
    if "restitution" not in words:
        return base
    if isinstance(law, str):
        missing = [name for name in law_parameters(law) if name not in arguments]
        if missing:
            raise ValueError(f"restitution={law!r}: needs {', '.join(missing)}")
        return LAWS[law](**arguments)
    # A plain function stays itself, so that what the user gave is what the scene has.
    needs_arguments = bool(arguments) or is_reference(words["restitution"])
    found: Restitution = own_law(law, arguments) if needs_arguments else law
    return found
