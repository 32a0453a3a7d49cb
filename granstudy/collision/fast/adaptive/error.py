"""The error of a quadrature, as a tolerance bounds it."""

import numpy as np
import scipy.fft

from granstudy.collision.fast.operator import NodalOperator
from granstudy.collision.fourier.spectra import long_axes, unaliased
from granstudy.velocity.cartesian import VelocityGrid

MOMENT_PART = 2.0
"""The error of a moment may be so many times that of Q (a uniform rule's is two to four times)."""

MOMENT_WEIGHT = 0.1
"""Part of the moments in the sum of squares that is made small, over that of all points."""

SAMPLES = 4096
"""Points of the grid, evenly spread, at which errors are added up while choosing."""

EQUILIBRIUM = 0.01
"""Near an equilibrium Q vanishes, while the errors of gain and loss do not. A tolerance counts there from
this part of the loss."""


def quadrature_error(operator: NodalOperator, finer: NodalOperator, f: np.ndarray) -> float:
    """The error that a tolerance bounds, of Q(f,f) at a density (`ErrorScale`)."""
    Q = finer(f)
    return ErrorScale(operator.grid, Q, magnitude(finer, f, Q)).error(operator(f) - Q)


class ErrorScale:
    """What errors E of Q are measured by, so that one number bounds E and its moments.

    The larger of max|E|/max|Q|, on the modes that aliasing does not reach, and of |∫φ E| over
    `MOMENT_PART` times ∫|φ Q|, φ = 1, v_i, |v|² (errors of mass, momentum and energy add up in time).
    """

    def __init__(self, grid: VelocityGrid, Q: np.ndarray, scale: float) -> None:
        self.scale = scale
        v = grid.velocities()
        tests = [np.ones(grid.shape), *v, sum(vi**2 for vi in v)]
        lost = scale / np.max(np.abs(Q))  # where Q nearly vanishes its moments do as well
        self._tests = np.array(
            [np.broadcast_to(t, grid.shape) / (np.sum(np.abs(t * Q)) * lost) for t in tests]
        ).reshape(len(tests), -1)

    def moments(self, errors: np.ndarray) -> np.ndarray:
        """∫φ E / ∫|φ Q| of errors (..., points)."""
        return errors @ self._tests.T

    def error(self, error: np.ndarray) -> float:
        """The error, as a number."""
        moments = np.max(np.abs(self.moments(error.ravel()))) / MOMENT_PART
        return float(max(difference(error) / self.scale, moments))

    def samples(self, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Errors (..., points) at some points over max|Q|, and their moments; all bounded alike.

        And weights with which the moments count in a sum of squares as much as all points.
        """
        points = errors[..., :: max(1, -(-errors.shape[-1] // SAMPLES))] / self.scale
        moments = self.moments(errors) / MOMENT_PART
        weights = np.full(points.shape[-1] + moments.shape[-1], 1.0 / points.shape[-1])
        weights[points.shape[-1] :] = MOMENT_WEIGHT / moments.shape[-1]
        return np.concatenate([points, moments], axis=-1), weights


def magnitude(operator: NodalOperator, f: np.ndarray, Q: np.ndarray) -> float:
    """max|Q|, or `EQUILIBRIUM` of max|Q⁻| where gain and loss cancel further than that."""
    return float(max(np.max(np.abs(Q)), EQUILIBRIUM * np.max(np.abs(operator.loss(f)))))


def difference(error: np.ndarray) -> float:
    """max|E| of the modes that aliasing does not reach."""
    wide = error.reshape(len(error), -1, len(error))
    axes = long_axes(wide)
    low = unaliased(scipy.fft.rfftn(wide, axes=axes))
    return float(np.max(np.abs(scipy.fft.irfftn(low, s=error.shape, axes=axes))))
