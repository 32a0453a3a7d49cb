"""Contributions of single shells to Q, rule by rule: the measurements that a plan is made from."""

from collections.abc import Sequence

import numpy as np

from granstudy.collision.fast.gain import GainSum
from granstudy.collision.fast.nodes import place_nodes
from granstudy.collision.fast.operator import nodal_loss, spectrum_axes
from granstudy.collision.fourier.spectra import density, half_spectrum, resize, unaliased
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule
from granstudy.quadrature.ladder import Ladder
from granstudy.velocity.cartesian import VelocityGrid


class Shells:
    """Contributions of single shells to Q(f,f), for one density on the solver's grid."""

    def __init__(self, scene: Scene, solver: SizedSolver, ladder: Ladder, f: np.ndarray) -> None:
        self.scene = scene
        self.solver = solver
        self.ladder = ladder
        self.grid = solver.grid(scene.dim)
        wide = np.ascontiguousarray(f).reshape(self.grid.three_axis_shape)
        # The density and its spectrum on the grid of the products.
        self._products = VelocityGrid(scene.dim, solver.product_points, solver.R)
        self._f_hat = resize(half_spectrum(wide), self._products.N)
        self._f = wide if solver.product_points == solver.N else density(self._f_hat)

    def contributions(self, radial: Rule, levels: Sequence[int | None]) -> np.ndarray:
        """Each shell's part of Q with the ladder's rule of its level; 0 for a shell whose level is None.

        The parts hold the modes that aliasing does not reach (`unaliased`). In the variant ``separate`` they
        exclude the loss, which has no quadrature error.

        Returns
        -------
        ndarray, shape (shells, N^d)
        """
        steps = [None if level is None else self.ladder.steps[level] for level in levels]
        reduced = [None if step is None else step.reduced for step in steps]
        nodes = place_nodes(self.scene, self.grid, radial, reduced)
        stops = nodes.ends
        shares = list(zip([0, *stops[:-1]], stops, strict=True))
        gain = GainSum(
            self.scene,
            self._products,
            nodes,
            self.solver.thread_count,
            shares,
            self.solver.precision,
        )
        result = np.zeros((len(radial), self.grid.N**self.grid.dim))
        for (start, _), part in zip(shares, gain.parts(self._f, self._f_hat), strict=True):
            shell = int(nodes.shells[start])
            Q = self._low_pass(part)
            if self.solver.variant == "full":
                pairs: list[Rule | None] = [None] * len(steps)
                pairs[shell] = self.ladder.steps[int(levels[shell] or 0)].pairs
                loss = nodal_loss(
                    self._products, place_nodes(self.scene, self._products, radial, pairs)
                )
                lost = density(spectrum_axes(self._products, loss) * self._f_hat)
                Q -= self._low_pass(half_spectrum(self._f * lost))
            result[shell] = self.ladder.group.symmetrise(Q.reshape(self.grid.shape)).ravel()
        return result

    def _low_pass(self, spectrum: np.ndarray) -> np.ndarray:
        """Values on the solver's grid, without the modes that aliasing reaches."""
        return density(unaliased(resize(spectrum, self.grid.N)))
