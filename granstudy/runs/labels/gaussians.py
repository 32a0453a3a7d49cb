"""Sums of Gaussians, densities of random runs with known moments that a run is told of or not."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.model.scene import Scene
from granstudy.model.stated_moments import StatedMoments, of_gaussians


@dataclass(frozen=True)
class Gaussians:
    """Σ_j m_j (2πs_j)^{−d/2} exp(−|v − c_j|²/(2s_j)); its moments are known, and not stated.

    Attributes
    ----------
    masses, variances : tuple of float
        m_j, and s_j.
    centres : tuple of tuple of float
        c_j.
    """

    masses: tuple[float, ...]
    centres: tuple[tuple[float, ...], ...]
    variances: tuple[float, ...]

    @property
    def dim(self) -> int:
        """Velocity dimension."""
        return len(self.centres[0])

    @property
    def symmetry(self) -> str:
        """All signed permutations where every Gaussian is about 0; else none."""
        return "none" if np.any(self.centres) else "full"

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """The density at the velocities v."""
        total = np.zeros(np.broadcast_shapes(*(np.shape(vi) for vi in v)))
        for m, c, s in zip(self.masses, self.centres, self.variances, strict=True):
            c2 = sum((vi - ci) ** 2 for vi, ci in zip(v, c, strict=True))
            total += m * np.exp(-c2 / (2 * s)) / (2 * np.pi * s) ** (len(v) / 2)
        return total

    @property
    def known_moments(self) -> StatedMoments:
        """Moments in closed form."""
        variances = [[s] * self.dim for s in self.variances]
        return of_gaussians(self.masses, self.centres, variances)

    @property
    def stating(self) -> "StatedGaussians":
        """The same density, which states its moments."""
        return StatedGaussians(self.masses, self.centres, self.variances)


@dataclass(frozen=True)
class StatedGaussians(Gaussians):
    """Gaussians that state their moments."""

    @property
    def moments(self) -> StatedMoments:
        """Moments in closed form."""
        return self.known_moments


def known_moments(scene: Scene) -> StatedMoments:
    """Moments of a random run's density in closed form, whether it states them or not."""
    initial: Any = scene.initial
    moments: StatedMoments = (
        initial.known_moments if isinstance(initial, Gaussians) else initial.moments
    )
    return moments


def told(scene: Scene) -> Scene:
    """The scene with a density that states its moments."""
    initial = scene.initial
    if not isinstance(initial, Gaussians):
        return scene
    gas = (scene.kernel, scene.restitution, scene.diffusion)
    return Scene(scene.dim, initial.stating, *gas)
