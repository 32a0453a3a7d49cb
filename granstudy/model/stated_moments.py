"""Moments that an initial density states in closed form, whatever a grid makes of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class StatedMoments:
    """Moments of a density on all of velocity space.

    Attributes
    ----------
    density : float
        ρ.
    velocity : ndarray, shape (d,)
        u.
    pressure : ndarray, shape (d, d)
        ∫(v−u)(v−u) f dv.
    a2 : float
        d/(d+2) ⟨|v−u|⁴⟩/⟨|v−u|²⟩² − 1.
    """

    density: float
    velocity: np.ndarray
    pressure: np.ndarray
    a2: float

    @property
    def temperature(self) -> float:
        """T = ∫|v−u|² f dv / (dρ)."""
        return float(np.trace(self.pressure) / (len(self.velocity) * self.density))


def isotropic(dim: int, temperature: float, a2: float) -> StatedMoments:
    """Moments of an isotropic density with ρ = 1 and u = 0."""
    return StatedMoments(1.0, np.zeros(dim), temperature * np.eye(dim), a2)


def of_gaussians(
    masses: Sequence[float],
    centres: Sequence[Sequence[float]],
    variances: Sequence[Sequence[float]],
) -> StatedMoments:
    """Moments of Σ_j m_j Π_i (2πs_ji)^{−1/2} exp(−(v_i − c_ji)²/(2s_ji)).

    With D = c − u and S = diag(s) of each: ⟨cc⟩ = DD + S, ⟨|c|⁴⟩ = (|D|² + tr S)² + 4 D·SD + 2 tr S².

    Parameters
    ----------
    masses, centres, variances : sequences, shapes (n,), (n, d) and (n, d)
        m_j, c_j and s_j, along the axes.
    """
    m, c, s = np.array(masses), np.array(centres), np.array(variances)
    density, dim = m.sum(), c.shape[1]
    velocity = m @ c / density
    D = c - velocity
    pressure = (m[:, None] * D).T @ D + np.diag(m @ s)
    fourth = m @ (
        (np.sum(D**2, axis=1) + np.sum(s, axis=1)) ** 2
        + 4 * np.sum(s * D**2, axis=1)
        + 2 * np.sum(s**2, axis=1)
    )
    square = np.trace(pressure)
    a2 = dim / (dim + 2) * fourth * density / square**2 - 1.0
    return StatedMoments(float(density), velocity, pressure, float(a2))
