"""The fast operator tuned to a tolerance, and tuned anew where a density has outgrown its quadrature."""

import numpy as np

from granstudy.collision.fast.adaptive.build import planned_operator, refine
from granstudy.collision.fast.adaptive.error import quadrature_error
from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.fast.adaptive.search import make_plan
from granstudy.collision.fast.operator import MakeOperator, nodal_operator
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver


class AdaptiveOperator:
    """Q(f,f) with a quadrature error under rtol at the density that the operator is tuned for.

    Attributes
    ----------
    plan : QuadraturePlan
        The quadrature in use, first made for the scene's initial density.
    """

    def __init__(
        self, scene: Scene, solver: SizedSolver, make: MakeOperator = nodal_operator
    ) -> None:
        self.scene = scene
        self.solver = solver
        self.grid = solver.grid(scene.dim)
        self._make = make
        self._use(make_plan(scene, solver, scene.density(self.grid)))

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density."""
        return self.operator(f)

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""
        self.operator.transform()

    def check(self, f: np.ndarray) -> float:
        """The error of Q(f,f) that rtol bounds, by a finer quadrature. It takes a few evaluations' time."""
        return quadrature_error(self.operator, self._finer, f)

    def tune(self, f: np.ndarray) -> QuadraturePlan:
        """Choose the quadrature anew for the density ``f``.

        Raises
        ------
        ToleranceError
            If the tolerance cannot be reached. The quadrature then stays as it was.
        """
        self._use(make_plan(self.scene, self.solver, f))
        return self.plan

    def _use(self, plan: QuadraturePlan) -> None:
        self.plan = plan
        self.operator = planned_operator(self.scene, self.solver, plan, self._make)
        self.transforms = self.operator.transforms
        finer = refine(self.scene, self.solver, plan)
        self._finer = planned_operator(self.scene, self.solver, finer, self._make)
