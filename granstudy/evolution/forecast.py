"""A forecast of a run: the method and why, what an evaluation of Q takes, seconds, memory, error."""

import dataclasses
import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from granstudy.collision.choice.cost import MethodCost, memory_mb, on_threads
from granstudy.collision.choice.methods import OPERATORS
from granstudy.collision.fast.adaptive.plan import QuadraturePlan, TunedOperator
from granstudy.collision.fast.adaptive.retuning import CHECK_EVERY
from granstudy.collision.operator import choose, collision_operator
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.times import TimeSettings
from granstudy.model.methods import METHODS
from granstudy.model.restitution import check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.particles.cost import EFFICIENCY, particle_cost
from granstudy.particles.restitution_table import alpha_table
from granstudy.theory import haff_constant

NOT_TIMED = "seconds are those of device 'cpu'"
"""What is said of a run on a GPU: no constants of `granstudy.collision.choice.cost` are."""


STEPS_PER_COLLISION = 5.0
"""Steps of an adaptive run in a unit of collision time: 2 near e = 1, 10 where velocities shrink fast."""

SECONDS_PER_STEP = 2.5e-4
"""Of a step's moments and checks whatever the grid."""

SECONDS_PER_STEP_POINT = 3.0e-8
"""Of a step's sums, moments and checks, a grid point."""


@dataclass(frozen=True, repr=False)
class Forecast:
    """What a run will be like, before it starts.

    Attributes
    ----------
    method, reason : str
        The method, and why where it was chosen.
    dim, N, R
        Velocity dimension, points (for `radial` speeds) and truncation radius.
    nodes : int
        Nodes of the sum an evaluation makes: pairs ±g or orbits of `fast`, all of `literal`; for
        `carleman` products, for `radial` and `direct` 0.
    transforms, n : int
        Fourier transforms of an evaluation, and the points a dimension of most of them.
    threads : int
    seconds_per_evaluation : float
    evaluations : int
        Evaluations of the whole run; 1 where no time was given.
    seconds : float
        Of the whole run, its set-up included; starting Python and loading compiled loops are not.
    memory_mb : int
        Of the process.
    error : float or None
        Estimate of what ``rtol`` bounds (`Solver.rtol`), None where nothing estimates it.
    plan : QuadraturePlan or None
        The quadrature that a tolerance came to.
    collisions : int
        Of all particles together, for `dsmc`, which evaluates nothing.
    """

    method: str
    reason: str
    dim: int
    N: int
    R: float
    nodes: int
    transforms: int
    n: int
    threads: int
    seconds_per_evaluation: float
    evaluations: int
    seconds: float
    memory_mb: int
    error: float | None
    plan: QuadraturePlan | None
    collisions: int = 0

    def describe(self) -> dict[str, Any]:
        """The forecast as plain data."""
        return dataclasses.asdict(self)

    def __repr__(self) -> str:
        if METHODS[self.method].by_particles:
            return (
                f"Forecast: {self.method}, box of N={self.N}, R={self.R:g} in {self.dim}D\n"
                f"  the run: {self.collisions:.2g} collisions, {self.seconds:.2g} s on {self.threads} "
                f"threads, {self.memory_mb} MB\n"
                "  error: by the batches, when it has run"
            )
        error = "not estimated" if self.error is None else f"{self.error:.1e}"
        lines = [
            f"Forecast: {self.method}, N={self.N}, R={self.R:g} in {self.dim}D",
            f"  why: {self.reason or 'as asked for'}",
            f"  an evaluation: {self.nodes} nodes, {self.transforms} transforms of {self.n}^{self.dim}"
            f" points, {self.seconds_per_evaluation:.2g} s"
            if self.transforms
            else f"  an evaluation: no transforms, {self.seconds_per_evaluation:.2g} s",
            f"  the run: {self.evaluations} evaluations, {self.seconds:.2g} s on {self.threads} threads"
            f", {self.memory_mb} MB",
            f"  error of Q over max|Q|: {error}",
        ]
        return "\n".join(lines)


def plan(
    scene: Scene,
    solver: Solver,
    t_final: float | None = None,
    dt: float | None = None,
    time_rtol: float | None = None,
    scheme: str | None = None,
) -> Forecast:
    """Say what a run will be like: of `simulate` where its times are given, else of one evaluation.

    A tolerance is planned for as the run would, which takes about a second. How many steps `time_rtol` takes
    is estimated within a factor 3. Of `dsmc` the collisions are counted along the law
    of cooling.

    Raises
    ------
    ValueError
        For a bad scene, solver or time, or a tolerance out of reach, or a `dsmc` without times.
    """
    if (t_final is None) != (dt is None and time_rtol is None):
        raise ValueError(f"t_final={t_final!r}, dt={dt!r}: give both, or neither")
    steps, evaluations = 0, 1
    if t_final is not None:
        settings = TimeSettings(t_final, dt, time_rtol, scheme=scheme)
        steps = expected_steps(scene, settings)
        evaluations = expected_evaluations(scene, settings)
    if solver.traits.by_particles:
        if t_final is None:
            raise ValueError(
                f"t_final=None: method {solver.method!r} has no evaluation of Q; give t_final and dt"
            )
        return _plan_particles(scene, solver.sized(), t_final, len(settings.recorded) - 1)
    choice = choose(scene, solver)
    chosen, cost = choice.solver, OPERATORS[choice.solver.method].cost
    check_restitution(scene.restitution, largest_speed=chosen.R)
    count = _count(scene, chosen, cost)
    one_thread = cost.seconds(scene, chosen, count.transforms, count.n)
    threads = chosen.thread_count
    each = on_threads(one_thread, cost.efficiency, threads)
    # A tolerance is checked now and then by a finer quadrature, at about a step's time.
    checks = 3 * steps / CHECK_EVERY if count.plan is not None else 0.0
    seconds = on_threads(cost.setup(scene, chosen, one_thread), cost.efficiency, threads)
    seconds += (evaluations + checks) * each + steps * step_seconds(scene, chosen)
    reasons = [choice.reason, NOT_TIMED if chosen.device == "gpu" else ""]
    return Forecast(
        method=chosen.method,
        reason="; ".join(filter(None, reasons)),
        dim=scene.dim,
        N=chosen.N,
        R=float(chosen.R),
        nodes=count.nodes,
        transforms=count.transforms,
        n=count.n,
        threads=threads,
        seconds_per_evaluation=each,
        evaluations=evaluations,
        seconds=seconds,
        memory_mb=memory_mb(cost.numbers(scene, chosen, count.transforms)),
        error=count.plan.error if count.plan else None,
        plan=count.plan,
    )


def _plan_particles(scene: Scene, solver: SizedSolver, t_final: float, steps: int) -> Forecast:
    alpha_table(scene.restitution, solver.R)
    cost, collisions = particle_cost(scene, solver, t_final, steps + 1)
    threads = solver.thread_count
    return Forecast(
        method=solver.method,
        reason="",
        dim=scene.dim,
        N=solver.N,
        R=float(solver.R),
        nodes=0,
        transforms=0,
        n=0,
        threads=threads,
        seconds_per_evaluation=0.0,
        evaluations=0,
        seconds=on_threads(cost.seconds, EFFICIENCY, threads),
        memory_mb=cost.memory_mb,
        error=None,
        plan=None,
        collisions=collisions,
    )


class _Count(NamedTuple):
    """Nodes and transforms of an evaluation, their points a dimension, and the quadrature planned."""

    nodes: int
    transforms: int
    n: int
    plan: QuadraturePlan | None = None


def _count(scene: Scene, solver: SizedSolver, cost: MethodCost) -> _Count:
    """Count what an evaluation makes; where that is known only then, by making the operator."""
    solver = replace(solver, device="cpu")  # the same sums, known without a GPU
    if cost.exact(solver):
        n = solver.product_points
        return _Count(cost.nodes(scene, solver), cost.transforms(scene, solver), n)
    operator = collision_operator(scene, solver)
    if isinstance(operator, TunedOperator):
        plan = operator.plan
        return _Count(plan.nodes, operator.transforms, plan.n, plan)
    return _Count(operator.transforms // 2 - 1, operator.transforms, solver.N)


def expected_steps(scene: Scene, settings: TimeSettings) -> int:
    """Steps that a run makes: exactly where dt sets them, else about as many, within a factor 3."""
    if settings.time_rtol is None:
        return settings.steps
    law = scene.restitution
    e = float(law(np.ones(1))[0]) if callable(law) else float(law)
    collisions = settings.t_final
    if scene.kernel.exponent > 0.0 and scene.diffusion == 0.0 and e < 1.0:
        # τ of a gas that cools by Haff's law from T = 1
        C0 = haff_constant(scene.kernel, e, scene.dim)
        collisions = np.log1p(C0 * settings.t_final) / C0
    return len(settings.outputs) + math.ceil(STEPS_PER_COLLISION * collisions)


def expected_evaluations(scene: Scene, settings: TimeSettings) -> int:
    """Evaluations of Q in those steps."""
    each = SCHEMES[settings.scheme].evaluations
    if settings.time_rtol is None:
        return each * settings.steps
    return each * expected_steps(scene, settings)


def step_seconds(scene: Scene, solver: SizedSolver) -> float:
    """Seconds that a step takes beside its evaluations."""
    points = solver.N if solver.traits.radial else solver.N**scene.dim
    return SECONDS_PER_STEP + SECONDS_PER_STEP_POINT * points
