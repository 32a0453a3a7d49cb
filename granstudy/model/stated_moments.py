"""Moments of initial densities in closed form, exact on all of velocity space."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class StatedMoments:
    """Moments of a density on all of velocity space.

    Attributes
    ----------
    density : float
        Mass ρ = ∫f dv.
    velocity : ndarray, shape (d,)
        Bulk velocity u = ∫v f dv / ρ.
    pressure : ndarray, shape (d, d)
        Pressure tensor ∫(v−u)(v−u) f dv.
    a2 : float
        Kurtosis excess d/(d+2) ⟨|v−u|⁴⟩/⟨|v−u|²⟩² − 1.
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

    A Gaussian with D = c − u and S = diag(s) has, about u, the second moments DD + S and the fourth moment
    (|D|² + tr S)² + 4 D·SD + 2 tr S².

    Parameters
    ----------
    masses : sequence, shape (n,)
        m_j.
    centres : sequence, shape (n, d)
        c_j.
    variances : sequence, shape (n, d)
        s_j along the axes.
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
