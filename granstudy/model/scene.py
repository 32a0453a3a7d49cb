"""Scene: the gas that is modelled, by its initial density, kernel, restitution, heating and symmetry."""

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from granstudy.model.densities import density_parameters, named_density
from granstudy.model.kernel import VHS, maxwell
from granstudy.model.restitution import Restitution, check_restitution
from granstudy.model.stated_moments import StatedMoments
from granstudy.support.checks import is_real
from granstudy.support.errors import unknown_name
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace, check_dim, check_shape
from granstudy.velocity.symmetry import Symmetry


@dataclass(frozen=True, init=False)
class Scene:
    """The gas that is modelled: ∂t f − ε Δv f = Q(f,f), f(0) = initial.

    Attributes
    ----------
    dim : int
        Velocity dimension, 2 or 3.
    initial : str or callable
        Initial density: a name out of `granstudy.model.densities.INITIAL_DENSITIES`, or a function of ``dim``
        broadcastable velocity components.
    kernel : VHS
        Collision kernel B(|g|).
    restitution : float or callable
        Restitution e in [0, 1], or e as a function of the normal impact speed |g·ω|.
    diffusion : float
        Heating ε ≥ 0.
    symmetry : Symmetry, str or None
        Signed permutations of the axes that leave the initial density as it is; every later density then
        has them too. A group, or the name of one: ``none``, ``inversion``, ``reflections``, ``exchange``,
        ``full``. None takes the density's own ``symmetry``; a plain function has none. The symmetry is
        verified where the density is put on a grid.

    Raises
    ------
    ValueError
        If a field has another value; the message says field, value and allowed.
    """

    dim: int
    initial: Callable[..., np.ndarray]
    kernel: VHS
    restitution: Restitution
    diffusion: float
    symmetry: Symmetry

    def __init__(
        self,
        dim: int,
        initial: str | Callable[..., np.ndarray],
        kernel: VHS,
        restitution: Restitution = 1.0,
        diffusion: float = 0.0,
        symmetry: Symmetry | str | None = None,
    ) -> None:
        check_dim(dim)
        if not isinstance(kernel, VHS):
            raise ValueError(f"kernel={kernel!r}: must be a granstudy.VHS")
        check_restitution(restitution)
        if not (is_real(diffusion) and 0.0 <= diffusion < math.inf):
            raise ValueError(f"diffusion={diffusion!r}: must be a number of at least 0")
        density = initial if callable(initial) else named_density(initial)()
        own_dim = getattr(density, "dim", dim)
        if own_dim != dim:
            raise ValueError(f"initial={density!r}: has dim {own_dim}, the scene {dim}")
        fields = {"dim": dim, "initial": density, "kernel": kernel, "restitution": restitution}
        for name, value in (fields | {"diffusion": diffusion}).items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "symmetry", self._group(symmetry))

    def _group(self, declared: Symmetry | str | None) -> Symmetry:
        """The group of the declared symmetry, or of the density's own."""
        if declared is None:
            declared = getattr(self.initial, "symmetry", "none")
        group = Symmetry.named(self.dim, declared) if isinstance(declared, str) else declared
        if not isinstance(group, Symmetry):
            raise ValueError(f"symmetry={declared!r}: must be a granstudy.Symmetry or its name")
        if group.dim != self.dim:
            raise ValueError(f"symmetry={group!r}: has dim {group.dim}, the scene {self.dim}")
        return group

    @property
    def moments(self) -> StatedMoments | None:
        """Moments of the initial density in closed form; None for a density that does not state them."""
        return getattr(self.initial, "moments", None)

    def density(self, grid: VelocitySpace) -> np.ndarray:
        """Initial density on a grid, an array of the shape ``grid.shape``.

        Raises
        ------
        ValueError
            For a grid of another dimension, and for a density that has another shape than the grid, is
            not finite, has no mass there, or lacks the declared symmetry.
        """
        if grid.dim != self.dim:
            raise ValueError(f"grid has dim {grid.dim}: the scene has dim {self.dim}")
        f = check_density(np.asarray(self.initial(*grid.velocities())), grid)
        if isinstance(grid, VelocityGrid):
            self.symmetry.check(f, f"initial={self.initial!r}")
        return f

    def coordinates(self) -> dict[str, Any]:
        """The scene's parameters that a study sweeps, by name (`granstudy.datasets.parameters`)."""
        e = self.restitution
        law = {"restitution": repr(e)} if callable(e) else {"e": float(e)}
        return {**law, "exponent": self.kernel.exponent, "epsilon": float(self.diffusion)}

    def describe(self) -> dict[str, Any]:
        """The scene as plain data, for a dataset's attributes."""
        return {
            "dim": self.dim,
            "initial": repr(self.initial),
            "kernel": dataclasses.asdict(self.kernel),
            "restitution": (
                repr(self.restitution) if callable(self.restitution) else float(self.restitution)
            ),
            "diffusion": float(self.diffusion),
            "symmetry": self.symmetry.name,
        }


@cache
def _overridden() -> frozenset[str]:
    """Fields of a scene that may differ where it is loaded by name."""
    return frozenset(field.name for field in dataclasses.fields(Scene)) - {"dim", "initial"}


def check_density(f: np.ndarray, grid: VelocitySpace) -> np.ndarray:
    """Return ``f`` as float64, or raise ValueError for its shape, type, values or mass on the grid."""
    check_shape(f, grid)
    if np.iscomplexobj(f) or not np.issubdtype(np.asarray(f).dtype, np.number):
        raise ValueError(f"density has type {np.asarray(f).dtype}: must be real numbers")
    f = np.ascontiguousarray(f, dtype=np.float64)
    if not np.all(np.isfinite(f)):
        bad = int(np.size(f) - np.count_nonzero(np.isfinite(f)))
        raise ValueError(f"density holds {bad} values that are NaN or infinite: all must be finite")
    if not f.sum() > 0.0:
        raise ValueError("density has no mass on the grid: its sum must be positive")
    return f


def load_scene(name: str, **overrides: Any) -> Scene:
    """A scene by its name, with any field overridden.

    The defaults are the paper's: Maxwell molecules of unit cross-section, e = 1, ε = 10⁻⁶.

    Parameters
    ----------
    name : str
        A name out of `granstudy.model.densities.INITIAL_DENSITIES`.
    overrides
        Fields of `Scene` but ``dim`` and ``initial``; and parameters of the density, which some names have in
        2D and 3D:

        ================  =================================
        ``maxwellian``    ``temperature``, ``velocity``
        ``uniform_ball``  ``temperature``
        ``power_law``     ``temperature``, ``tail``
        ``two_beams``     ``temperature``, ``separation``
        ================  =================================

    Raises
    ------
    ValueError
        For an unknown name or override, or a value that its field does not allow.
    """
    make = named_density(name)
    fields = _overridden()
    scene_fields = {key: value for key, value in overrides.items() if key in fields}
    own = {key: value for key, value in overrides.items() if key not in fields}
    allowed = {parameter.name for parameter in density_parameters(name)}
    for key in own:
        if key not in allowed:
            raise unknown_name(f"field of scene {name!r}", key, sorted(fields | allowed))
    initial = make(**own)
    paper: dict[str, Any] = {"kernel": maxwell(initial.dim), "diffusion": 1e-6}
    return Scene(initial.dim, initial, **paper | scene_fields)
