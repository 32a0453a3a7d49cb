"""Scene: the gas that is modelled, by its initial density, kernel, restitution, heating and symmetry."""

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.model import identity
from granstudy.model.densities import named_density
from granstudy.model.kernel import VHS
from granstudy.model.restitution import Restitution, check_restitution
from granstudy.model.stated_moments import StatedMoments
from granstudy.support.checks import answer, is_real, plain
from granstudy.support.own_code.code import Code
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace, check_dim, check_shape
from granstudy.velocity.symmetry import Symmetry

FUTURE = "from __future__ import annotations\n\n"
"""Head of a source: it runs without the types that annotations name."""


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
        dim = plain(dim)
        check_dim(dim)
        if not isinstance(kernel, VHS):
            raise ValueError(f"kernel={kernel!r}: must be a granstudy.VHS")
        check_restitution(restitution)
        if not (is_real(diffusion) and 0.0 <= diffusion < math.inf):
            raise ValueError(f"diffusion={diffusion!r}: must be a number of at least 0")
        diffusion = float(plain(diffusion))
        if not callable(restitution):
            restitution = float(plain(restitution))
        density = initial if callable(initial) else named_density(initial)()
        own_dim = getattr(density, "dim", dim)
        if own_dim != dim:
            raise ValueError(f"initial={density!r}: has dim {own_dim}, the scene {dim}")
        fields = {"dim": dim, "initial": density, "kernel": kernel, "restitution": restitution}
        for name, value in (fields | {"diffusion": diffusion}).items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "symmetry", self._group(symmetry))

    def __hash__(self) -> int:
        # Without density and law, which need not be hashable; == compares them.
        return hash((self.dim, self.kernel, self.diffusion, self.symmetry.name))

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
        f = answer(f"initial={self.initial!r}", self.initial, *grid.velocities())
        f = check_density(f, grid)
        if isinstance(grid, VelocityGrid):
            self.symmetry.check(f, f"initial={self.initial!r}")
        return f

    def coordinates(self) -> dict[str, Any]:
        """The scene's parameters by name, the density's and the law's own arguments among them.

        Names are those of `granstudy.datasets.parameters`. Values are numbers; vectors are texts.
        """
        law = self.restitution
        if callable(law):
            restitution: dict[str, Any] = {"restitution": identity.label(law)}
            own = identity.arguments(law)
        else:
            restitution, own = {"e": law}, {}
        return {
            "scene": identity.label(self.initial),
            **restitution,
            "exponent": self.kernel.exponent,
            "strength": self.kernel.strength,
            "diffusion": self.diffusion,
            **identity.arguments(self.initial, self.dim),
            **own,
        }

    def describe(self) -> dict[str, Any]:
        """The scene as plain data, for a dataset's attributes.

        Densities and laws of granstudy are described by their ``repr``; functions of the user by name,
        arguments and a digest of their code.
        """
        law, known = self.restitution, self._contents()
        return {
            "dim": self.dim,
            "initial": identity.described(self.initial, self.dim, known[0]),
            "kernel": dataclasses.asdict(self.kernel),
            "restitution": identity.described(law, None, known[1]) if callable(law) else law,
            "diffusion": self.diffusion,
            "symmetry": self.symmetry.name,
        }

    def identity(self) -> dict[str, Any]:
        """All that decides a run of the scene: as `describe`, with digests alone for functions of the user.

        Raises
        ------
        ValueError
            If such a function reaches a value that has no content to be known by.
        """
        described = self.describe()
        for name in ("initial", "restitution"):
            if isinstance(described[name], dict):
                if "unidentified" in described[name]:
                    raise ValueError(described[name]["unidentified"])
                described[name] = described[name]["digest"]
        return described

    @property
    def source(self) -> str:
        """Source of the user's own density and law; "" where all is granstudy's or cannot be known."""
        texts = [known.source for known in self._contents() if known is not None]
        return FUTURE + "\n\n".join(texts) if texts else ""

    def _contents(self) -> tuple[Code | None, Code | None]:
        """Contents of the density and the law, None for what is not the user's or cannot be known.

        A scene that comes from another process has the contents from there: a function that was sent has
        lost its source.
        """
        sent: tuple[Code | None, Code | None] | None = self.__dict__.get("_sent")
        if sent is not None:
            return sent
        return identity.known(self.initial, self.dim), identity.known(self.restitution)

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_sent": self._contents()}


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
        raise ValueError(
            f"density has no mass on the grid of N={grid.shape[0]}, R={grid.R:g}: its sum must be positive"
        )
    return f
