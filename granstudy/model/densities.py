"""Initial densities by name: functions of the velocity components that know their symmetry and moments."""

import dataclasses
import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Protocol

import numpy as np
from scipy.special import gamma

from granstudy.model.stated_moments import StatedMoments, isotropic, of_gaussians
from granstudy.support.checks import check_positive, is_real, plain
from granstudy.support.errors import unknown_name
from granstudy.velocity.symmetry import Symmetry, stabiliser

THREE_GAUSSIANS = (
    (0.5, (0.6, -0.3, 0.2), (0.9, 0.7, 0.6)),
    (0.3, (-0.7, 0.5, -0.6), (0.6, 0.8, 1.0)),
    (0.2, (-0.45, 0.0, 0.4), (0.7, 1.0, 0.65)),
)
"""Mass, centre and variances along the axes of each Gaussian of `ThreeGaussians3D`."""


class InitialDensity(Protocol):
    """Anything that maps d broadcastable velocity components to density values.

    A density may declare its ``symmetry``, a `granstudy.Symmetry` or the name of one. A density may state its
    ``moments``, a `StatedMoments`; the estimated errors of a run then include what the grid does to them.
    """

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """Density at the velocities ``v``."""


class NamedDensity(InitialDensity, Protocol):
    """An initial density that has a name, and a velocity dimension of its own."""

    @property
    def dim(self) -> int: ...  # noqa: D102


def parameter(default: Any, text: str) -> Any:
    """A field of a density that users set, with its explanation in the schema of study files."""
    return dataclasses.field(default=default, metadata={"help": text})


@dataclass(frozen=True)
class Bkw2D:
    """Isotropic scene of the paper's eq. 49, K = 1 − exp(−1/16)/2, T0 = 1."""

    dim: ClassVar[int] = 2
    symmetry: ClassVar[str] = "full"
    K: ClassVar[float] = float(1.0 - np.exp(-1.0 / 16.0) / 2.0)
    moments: ClassVar[StatedMoments] = isotropic(2, 1.0, -((1.0 - K) ** 2))

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = 1/(2πK²) e^{−v²/2K} (2K − 1 + (1−K)/(2K) v²)."""
        K = self.K
        v2 = _squared(v, (0.0, 0.0))
        return np.exp(-v2 / (2 * K)) * (2 * K - 1 + (1 - K) / (2 * K) * v2) / (2 * np.pi * K**2)


@dataclass(frozen=True)
class Bkw3D:
    """Isotropic scene of the paper's eq. 51, K = 1 − exp(−6.5/6), T0 = 1."""

    dim: ClassVar[int] = 3
    symmetry: ClassVar[str] = "full"
    K: ClassVar[float] = float(1.0 - np.exp(-6.5 / 6.0))
    moments: ClassVar[StatedMoments] = isotropic(3, 1.0, -((1.0 - K) ** 2))

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = 1/(2(2πK)^{3/2}) e^{−v²/2K} ((5K−3)/K + (1−K)/K² v²)."""
        K = self.K
        v2 = _squared(v, (0.0, 0.0, 0.0))
        return (
            np.exp(-v2 / (2 * K))
            * ((5 * K - 3) / K + (1 - K) / K**2 * v2)
            / (2 * (2 * np.pi * K) ** 1.5)
        )


@dataclass(frozen=True)
class DoubleWell2D:
    """Two beams, the paper's eq. 50: ρ = 1, u = 0, T0 = 1.425."""

    dim: ClassVar[int] = 2
    symmetry: ClassVar[str] = "exchange"
    moments: ClassVar[StatedMoments] = of_gaussians(
        (0.2, 0.8), ((2.0,) * 2, (-0.5,) * 2), ((1 / 8,) * 2, (1 / 2,) * 2)
    )

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = (0.8/π) (e^{−4|v−(2,2)|²} + e^{−|v+(½,½)|²})."""
        return (0.8 / np.pi) * (
            np.exp(-4.0 * _squared(v, (2.0, 2.0))) + np.exp(-_squared(v, (-0.5, -0.5)))
        )


@dataclass(frozen=True)
class DoubleWell3D:
    """Two beams in 3D (published version of the paper, Tables 6 to 8)."""

    dim: ClassVar[int] = 3
    symmetry: ClassVar[str] = "exchange"
    moments: ClassVar[StatedMoments] = of_gaussians(
        (0.2, 0.8), ((2.0,) * 3, (-0.5,) * 3), ((16.0 ** (-1 / 3) / 2,) * 3, (1 / 2,) * 3)
    )

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = 4/(5π^{3/2}) (e^{−16^{1/3}|v−(2,2,2)|²} + e^{−|v+(½,½,½)|²})."""
        return (0.8 / np.pi**1.5) * (
            np.exp(-(16.0 ** (1.0 / 3.0)) * _squared(v, (2.0, 2.0, 2.0)))
            + np.exp(-_squared(v, (-0.5, -0.5, -0.5)))
        )


@dataclass(frozen=True)
class ThreeGaussians3D:
    """A density without symmetry: three anisotropic Gaussians, ρ = 1, u = 0, T0 = 0.979."""

    dim: ClassVar[int] = 3
    symmetry: ClassVar[str] = "none"
    moments: ClassVar[StatedMoments] = of_gaussians(
        [mass for mass, _, _ in THREE_GAUSSIANS],
        [centre for _, centre, _ in THREE_GAUSSIANS],
        [variances for _, _, variances in THREE_GAUSSIANS],
    )

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = Σ_j m_j Π_i (2πs_ji)^{−1/2} exp(−(v_i − c_ji)²/(2s_ji)), by `THREE_GAUSSIANS`."""
        f = np.zeros(np.broadcast_shapes(*(vi.shape for vi in v)))
        for mass, centre, variances in THREE_GAUSSIANS:
            scaled = [vi / np.sqrt(s) for vi, s in zip(v, variances, strict=True)]
            place = [c / np.sqrt(s) for c, s in zip(centre, variances, strict=True)]
            norm = np.sqrt(np.prod(2 * np.pi * np.array(variances)))
            f += mass / norm * np.exp(-_squared(scaled, place) / 2)
        return f


@dataclass(frozen=True)
class Maxwellian:
    """Maxwellian of unit density with bulk ``velocity`` and ``temperature``."""

    dim: int
    temperature: float = parameter(1.0, "temperature T, default 1")
    velocity: tuple[float, ...] | None = parameter(None, "bulk velocity u, default 0")

    def __post_init__(self) -> None:
        set_positive(self, "temperature")
        velocity = (0.0,) * self.dim if self.velocity is None else self.velocity
        components = tuple(velocity) if np.iterable(velocity) else ()
        if len(components) != self.dim or not all(
            is_real(u) and math.isfinite(u) for u in components
        ):
            raise ValueError(f"velocity={self.velocity!r}: must be {self.dim} finite numbers")
        object.__setattr__(self, "velocity", tuple(float(plain(u)) for u in components))

    @property
    def symmetry(self) -> Symmetry:
        """The signed permutations that leave the bulk velocity as it is."""
        assert self.velocity is not None
        return stabiliser(Symmetry.named(self.dim, "full"), self.velocity)

    @property
    def moments(self) -> StatedMoments:
        """Moments of a Gaussian."""
        assert self.velocity is not None
        return of_gaussians((1.0,), (self.velocity,), ((self.temperature,) * self.dim,))

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = (2πT)^{−d/2} exp(−|v−u|²/(2T))."""
        T = self.temperature
        assert self.velocity is not None
        return np.exp(-_squared(v, self.velocity) / (2 * T)) / (2 * np.pi * T) ** (self.dim / 2)


@dataclass(frozen=True)
class UniformBall:
    """A ball (a disk in 2D) of constant density, ρ = 1, u = 0, of the given ``temperature``.

    The radius is a = √((d+2)T), by ⟨v²⟩ = d/(d+2) a²; ⟨v⁴⟩ = d/(d+4) a⁴.
    """

    dim: int
    temperature: float = parameter(1.0, "temperature T, default 1")
    symmetry: ClassVar[str] = "full"

    def __post_init__(self) -> None:
        set_positive(self, "temperature")

    @property
    def radius(self) -> float:
        """Radius a."""
        return float(np.sqrt((self.dim + 2) * self.temperature))

    @property
    def moments(self) -> StatedMoments:
        """T, and a2 = −2/(d+4)."""
        return isotropic(self.dim, self.temperature, -2.0 / (self.dim + 4))

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = Γ(d/2+1) / (√π a)^d for |v| < a, 0 elsewhere."""
        d, a = self.dim, self.radius
        inside = _squared(v, (0.0,) * d) < a**2
        return np.where(inside, gamma(d / 2 + 1) / (np.sqrt(np.pi) * a) ** d, 0.0)


@dataclass(frozen=True)
class PowerLaw:
    """Isotropic density whose tail falls like |v|^{−s}, ρ = 1, u = 0, of the given ``temperature``.

    With w² = (s − d − 2) T: ⟨v²⟩ = w² d/(s−d−2), ⟨v⁴⟩ = w⁴ d(d+2)/((s−d−2)(s−d−4)). The ``tail`` s must be
    above d + 4, as ⟨v⁴⟩ is infinite below.
    """

    dim: int
    tail: float = parameter(12.0, "s of the tail |v|^-s, above d + 4, default 12")
    temperature: float = parameter(1.0, "temperature T, default 1")
    symmetry: ClassVar[str] = "full"

    def __post_init__(self) -> None:
        set_positive(self, "temperature")
        if not (is_real(self.tail) and np.isfinite(self.tail) and self.tail > self.dim + 4):
            raise ValueError(
                f"tail={self.tail!r}: must be a number above {self.dim + 4}, for a finite fourth moment"
            )
        object.__setattr__(self, "tail", float(self.tail))

    @property
    def moments(self) -> StatedMoments:
        """T, and a2 = 2/(s−d−4)."""
        return isotropic(self.dim, self.temperature, 2.0 / (self.tail - self.dim - 4))

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = Γ(s/2) / (Γ((s−d)/2) (√π w)^d) (1 + v²/w²)^{−s/2}."""
        d, s = self.dim, self.tail
        w2 = (s - d - 2) * self.temperature
        norm = gamma(s / 2) / gamma((s - d) / 2) / (np.pi * w2) ** (d / 2)
        return norm * (1.0 + _squared(v, (0.0,) * d) / w2) ** (-s / 2)


@dataclass(frozen=True)
class TwoBeams:
    """Two Maxwellians of mass ½ and given ``temperature``, ``separation`` apart along the first axis.

    ρ = 1, u = 0; the temperature of both together is T + (separation)²/(4d).
    """

    dim: int
    separation: float = parameter(4.0, "distance of the beams, default 4")
    temperature: float = parameter(1.0, "temperature T of each beam, default 1")

    def __post_init__(self) -> None:
        for field in ("separation", "temperature"):
            set_positive(self, field)

    @property
    def _centre(self) -> tuple[float, ...]:
        return (self.separation / 2, *(0.0,) * (self.dim - 1))

    @property
    def symmetry(self) -> Symmetry:
        """The signed permutations that keep the line of the beams."""
        generators = {2: ("-x,y", "x,-y"), 3: ("-x,y,z", "x,-y,z", "x,z,y")}
        return Symmetry.generated(self.dim, *generators[self.dim])

    @property
    def moments(self) -> StatedMoments:
        """Moments of two Gaussians."""
        beams = (self._centre, tuple(-c for c in self._centre))
        return of_gaussians((0.5, 0.5), beams, ((self.temperature,) * self.dim,) * 2)

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = ½ (2πT)^{−d/2} Σ_± exp(−|v ∓ c|²/(2T)), c half the separation along the first axis."""
        T, c = self.temperature, self._centre
        beams = [np.exp(-_squared(v, [s * ci for ci in c]) / (2 * T)) for s in (1.0, -1.0)]
        return (beams[0] + beams[1]) / (2 * (2 * np.pi * T) ** (self.dim / 2))


INITIAL_DENSITIES: dict[str, Callable[..., NamedDensity]] = {
    "bkw2d": Bkw2D,
    "bkw3d": Bkw3D,
    "double_well2d": DoubleWell2D,
    "double_well3d": DoubleWell3D,
    "three_gaussians3d": ThreeGaussians3D,
    "maxwellian2d": partial(Maxwellian, 2),
    "maxwellian3d": partial(Maxwellian, 3),
    "uniform_ball2d": partial(UniformBall, 2),
    "uniform_ball3d": partial(UniformBall, 3),
    "power_law2d": partial(PowerLaw, 2),
    "power_law3d": partial(PowerLaw, 3),
    "two_beams2d": partial(TwoBeams, 2),
    "two_beams3d": partial(TwoBeams, 3),
}
"""Makers of the initial densities by name; a new scene is a new row."""


def scene_names() -> list[str]:
    """Names that `load_scene` knows."""
    return sorted(INITIAL_DENSITIES)


def named_density(name: object) -> Callable[..., NamedDensity]:
    """The maker of the initial density of that name; ValueError for an unknown name."""
    if not isinstance(name, str) or name not in INITIAL_DENSITIES:
        raise unknown_name("scene", name, scene_names())
    return INITIAL_DENSITIES[name]


def is_named(initial: object) -> bool:
    """Whether a density is one of `INITIAL_DENSITIES`, immutable: two that are equal have the same values."""
    named = any(type(initial) is _class(name) for name in INITIAL_DENSITIES)
    return named and isinstance(initial, Hashable)


def density_parameters(name: str) -> tuple[dataclasses.Field[Any], ...]:
    """Parameters that users can set of the density of that name: its fields without the dimension."""
    density = _class(name)
    fields = dataclasses.fields(density) if dataclasses.is_dataclass(density) else ()
    return tuple(field for field in fields if field.name != "dim")


def set_positive(density: NamedDensity, field: str) -> None:
    """Check that a field is a positive number, and keep it as one of Python."""
    value = getattr(density, field)
    check_positive(field, value)
    object.__setattr__(density, field, float(value))


def _class(name: str) -> Any:
    """The class of the initial density of that name."""
    made = INITIAL_DENSITIES[name]
    return made.func if isinstance(made, partial) else made


def _squared(v: Sequence[np.ndarray], centre: Sequence[float]) -> np.ndarray:
    """|v − centre|²."""
    return np.asarray(sum((vi - ci) ** 2 for vi, ci in zip(v, centre, strict=True)))
