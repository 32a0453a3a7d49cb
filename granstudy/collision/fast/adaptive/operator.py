"""The fast operator tuned to a tolerance, and tuned anew where a density has outgrown its quadrature."""

from typing import Any

import numpy as np

from granstudy.collision.fast.adaptive.build import planned_operator, refine
from granstudy.collision.fast.adaptive.error import quadrature_error
from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.fast.adaptive.search import make_plan
from granstudy.collision.fast.operator import MakeOperator, nodal_operator
from granstudy.collision.fourier.threads import OneAtATime
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.velocity.symmetry import Symmetry


class AdaptiveOperator:
    """Q(f,f) with a quadrature error under rtol at the density that the operator is tuned for.

    Parameters
    ----------
    plan : QuadraturePlan, optional
        The quadrature to start with, by default made for the scene's initial density.

    Attributes
    ----------
    plan : QuadraturePlan
        The quadrature in use.
    """

    def __init__(
        self,
        scene: Scene,
        solver: SizedSolver,
        make: MakeOperator = nodal_operator,
        plan: QuadraturePlan | None = None,
    ) -> None:
        self._one_at_a_time = OneAtATime()
        self.scene = scene
        self.solver = solver
        self.grid = solver.grid(scene.dim)
        self._make = make
        self._use(make_plan(scene, solver, scene.density(self.grid)) if plan is None else plan)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density."""
        with self._one_at_a_time:
            return self.operator(f)

    @property
    def group(self) -> Symmetry:
        """The symmetry that densities must have."""
        return self.operator.group

    @property
    def fftw_wisdom(self) -> str:
        """Hash of the wisdom that FFTW planned with; "" where it had none."""
        return self.operator.fftw_wisdom

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""
        with self._one_at_a_time:
            self.operator.transform()

    def check(self, f: np.ndarray) -> float:
        """The error of Q(f,f) that rtol bounds, by a finer quadrature. It takes a few evaluations' time."""
        with self._one_at_a_time:
            return quadrature_error(self.operator, self._finer, f)

    def tune(self, f: np.ndarray) -> QuadraturePlan:
        """Choose the quadrature anew for the density ``f``.

        Raises
        ------
        ToleranceError
            If the tolerance cannot be reached. The quadrature then stays as it was.
        """
        plan = make_plan(self.scene, self.solver, f)
        self.use(plan)
        return plan

    def use(self, plan: QuadraturePlan) -> None:
        """Take a quadrature that was chosen before."""
        with self._one_at_a_time:
            self._use(plan)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled are the scene, the solver and the plan in use: nothing is chosen again."""
        return type(self), (self.scene, self.solver, self._make, self.plan)

    def _use(self, plan: QuadraturePlan) -> None:
        self.plan = plan
        self.operator = planned_operator(self.scene, self.solver, plan, self._make)
        self.transforms = self.operator.transforms
        finer = refine(self.scene, self.solver, plan)
        self._finer = planned_operator(self.scene, self.solver, finer, self._make)
