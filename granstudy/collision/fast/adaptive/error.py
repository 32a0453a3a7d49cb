"""The quadrature error of Q as one number, which a tolerance bounds (`Solver.rtol`)."""

import numpy as np
import scipy.fft

from granstudy.collision.fast.operator import GainLossOperator
from granstudy.collision.fourier.spectra import long_axes, unaliased
from granstudy.velocity.cartesian import VelocityGrid

MOMENT_PART = 2.0
"""Relative error of a moment, over that of Q, at which both count alike. A uniform rule's is two to four."""

MOMENT_WEIGHT = 0.1
"""Weight of all moments together in the sum of squares that is made small. All points together weigh 1."""

SAMPLES = 4096
"""Most points of the grid at which errors are added up while rules are chosen."""

EQUILIBRIUM = 0.01
"""Smallest scale of Q, in parts of the loss. Near an equilibrium Q vanishes, while the errors of gain and
loss do not."""


def quadrature_error(operator: GainLossOperator, finer: GainLossOperator, f: np.ndarray) -> float:
    """The error of Q(f,f) at a density, by a finer operator: the number that a tolerance bounds."""
    Q = finer(f)
    return ErrorScale(operator.grid, Q, magnitude(finer, f, Q)).error(operator(f) - Q)


class ErrorScale:
    """A scale for errors E of Q, by which one number bounds E and its moments.

    The number is the larger of

        max|E| / max|Q|                        on the modes that aliasing does not reach
        |∫φ E| / (`MOMENT_PART` ∫|φ Q|)        for φ = 1, v_i, |v|²

    Moments count, as errors of mass, momentum and energy add up in time.
    """

    def __init__(self, grid: VelocityGrid, Q: np.ndarray, scale: float) -> None:
        self.scale = scale
        self._sampled = _spread(grid)
        v = grid.velocities()
        tests = [np.ones(grid.shape), *v, sum(vi**2 for vi in v)]
        lost = scale / np.max(np.abs(Q))  # above 1 where Q nearly vanishes, and its moments with it
        self._tests = np.array(
            [np.broadcast_to(t, grid.shape) / (np.sum(np.abs(t * Q)) * lost) for t in tests]
        ).reshape(len(tests), -1)

    def moments(self, errors: np.ndarray) -> np.ndarray:
        """∫φ E / ∫|φ Q| of errors (..., points)."""
        return errors @ self._tests.T

    def error(self, error: np.ndarray) -> float:
        """The error E as one number."""
        moments = np.max(np.abs(self.moments(error.ravel()))) / MOMENT_PART
        return float(max(difference(error) / self.scale, moments))

    def samples(self, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Errors at `SAMPLES` points and errors of the moments, scaled so that one bound holds for all.

        Parameters
        ----------
        errors : ndarray, shape (..., points)

        Returns
        -------
        tuple of ndarray, shapes (..., samples) and (samples,)
            The scaled errors, and weights of their squares in a sum (`MOMENT_WEIGHT`).
        """
        points = errors[..., self._sampled] / self.scale
        moments = self.moments(errors) / MOMENT_PART
        weights = np.full(points.shape[-1] + moments.shape[-1], 1.0 / points.shape[-1])
        weights[points.shape[-1] :] = MOMENT_WEIGHT / moments.shape[-1]
        return np.concatenate([points, moments], axis=-1), weights


def _spread(grid: VelocityGrid) -> slice | np.ndarray:
    """Places of at most `SAMPLES` points that are spread over a grid.

    They are equidistant, or chosen at random where their distance would be a row of the grid or more: 64 on
    64³ points would take one face of the box, where every error is 0.
    """
    count = grid.N**grid.dim
    distance = max(1, -(-count // SAMPLES))
    if distance < grid.N:
        return slice(None, None, distance)
    return np.sort(np.random.default_rng(0).choice(count, SAMPLES, replace=False))


def magnitude(operator: GainLossOperator, f: np.ndarray, Q: np.ndarray) -> float:
    """Scale of Q: max|Q|, and at least `EQUILIBRIUM` times max|Q⁻|."""
    return float(max(np.max(np.abs(Q)), EQUILIBRIUM * np.max(np.abs(operator.loss(f)))))


def difference(error: np.ndarray) -> float:
    """max|E| on the modes that aliasing does not reach."""
    wide = error.reshape(len(error), -1, len(error))
    axes = long_axes(wide)
    low = unaliased(scipy.fft.rfftn(wide, axes=axes))
    return float(np.max(np.abs(scipy.fft.irfftn(low, s=error.shape, axes=axes))))
