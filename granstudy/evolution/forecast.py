"""Forecasts: method, nodes, evaluations, seconds, memory and error of a run before it starts."""

import dataclasses
import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from granstudy.collision.choice.cost import Cost, MethodCost, memory_mb, on_threads
from granstudy.collision.choice.methods import OPERATORS
from granstudy.collision.fast.adaptive.plan import QuadraturePlan, TunedOperator
from granstudy.collision.fast.adaptive.retuning import CHECK_EVERY, LONG_STEP
from granstudy.collision.operator import choose, collision_operator
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.stability import adaptive_steps
from granstudy.evolution.times import TimeSettings
from granstudy.model.choice import Choice
from granstudy.model.methods import METHODS
from granstudy.model.restitution import check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.particles.cost import EFFICIENCY, particle_cost
from granstudy.particles.restitution_table import alpha_table
from granstudy.trust.balance_times import BALANCES
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

NOT_TIMED = "seconds are those of device 'cpu'"
"""Remark on a run on a GPU: all constants of costs were measured on a CPU."""

SETUP_SECONDS = 0.03
"""Seconds of a run's start and end, whatever the grid: checks, exact law, dataset."""

SECONDS_PER_STEP, SECONDS_PER_OUTPUT = 1.5e-4, 5.0e-4
"""Seconds of a step beside Q, and of an output, whatever the grid: moments, checks, signs of health."""

SECONDS_PER_STEP_POINT, SECONDS_PER_OUTPUT_POINT = 6.0e-8, 1.3e-7
"""The same for each point of a Cartesian grid."""

SECONDS_PER_BALANCE_POINT = 3.5e-8
"""Seconds of a balance (`granstudy.trust.error_estimate`), for each point of twice the box."""

SECONDS_PER_FRAME_POINT = 8.0e-8
"""Seconds of the motion of a rescaled frame in an evaluation, for each grid point."""


OPERATORS_OF_A_LAW = 3.5
"""Operators that an evaluation takes, on average, of a restitution law in a rescaled frame."""


@dataclass(frozen=True, repr=False)
class Forecast:
    """What a run will take, and how accurate its Q will be, before it starts.

    Attributes
    ----------
    method : str
    reason : str
        Why the method was chosen; "" where it was asked for.
    dim : int
        Velocity dimension.
    N : int
        Points in each dimension; for `radial`, speeds.
    R : float
        Truncation radius.
    nodes : int
        Terms of the sum that an evaluation makes: pairs ±g or orbits of them (`fast`), all nodes (`literal`),
        products (`carleman`), 0 (`radial`, `direct`).
    transforms : int
        Fourier transforms in an evaluation.
    n : int
        Points a dimension of most transforms.
    threads : int
    seconds_per_evaluation : float
    evaluations : int
        Evaluations in the whole run; 1 where no time was given.
    seconds : float
        Seconds of the whole run and its set-up; starting Python and loading compiled loops are excluded.
    memory_mb : int
        Megabytes of the process.
    error : float or None
        Estimate of the error that ``rtol`` bounds (`granstudy.Solver`); None without a tolerance.
    plan : QuadraturePlan or None
        The quadrature chosen for a tolerance.
    collisions : int
        Collisions of all particles together, for `dsmc`, which evaluates nothing.
    frame : str
        ``fixed`` or ``rescaled``.
    accuracy : dict of float, or None
        The accuracy asked for, of T and a2. All else is then what the run begins with, as it chooses anew on
        its way.
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
    frame: str = "fixed"
    accuracy: dict[str, float] | None = None

    def describe(self) -> dict[str, Any]:
        """The forecast as plain data."""
        return dataclasses.asdict(self)

    def __repr__(self) -> str:
        end = f"{self.seconds:.2g} s on {self.threads} threads, {self.memory_mb} MB"
        if METHODS[self.method].by_particles:
            return (
                f"Forecast: {self.method}, box of N={self.N}, R={self.R:g} in {self.dim}D\n"
                f"  the run: {self.collisions:.2g} collisions, {end}\n"
                "  error: by the batches, when it has run"
            )
        sums = "no transforms"
        if self.transforms:
            points = f"{self.n}^{self.dim} points"
            sums = f"{self.nodes} nodes, {self.transforms} transforms of {points}"
        error = "not estimated" if self.error is None else f"{self.error:.1e}"
        head = f"Forecast: {self.method}, N={self.N}, R={self.R:.3g} in {self.dim}D"
        if self.accuracy is not None:
            asked = ", ".join(f"{name} to {error:g}" for name, error in self.accuracy.items())
            head = f"{head}, {self.frame} frame, to begin with\n  asked: {asked}"
        return (
            f"{head}\n"
            f"  why: {self.reason or 'as asked for'}\n"
            f"  an evaluation: {sums}, {self.seconds_per_evaluation:.2g} s\n"
            f"  the run: {self.evaluations} evaluations, {end}\n"
            f"  error of Q over max|Q|: {error}"
        )


def plan(
    scene: Scene,
    solver: Solver,
    t_final: float | None = None,
    dt: float | None = None,
    time_rtol: float | None = None,
    scheme: str | None = None,
    frame: str = "fixed",
) -> Forecast:
    """Forecast a run of `granstudy.simulate`; without times, one evaluation of Q.

    A solver that leaves grid or method open is completed, and a tolerance is planned for, as the run would
    do; a plan takes about a second.

    Parameters
    ----------
    scene : Scene
    solver : Solver
    t_final, dt, time_rtol, scheme, frame
        Times as of `granstudy.simulate`; ``t_final`` comes with ``dt`` or ``time_rtol``.

    Returns
    -------
    Forecast
        With ``time_rtol``, the number of steps is an estimate, off by less than a factor 2 in 119 of 120 runs
        that were tried (`granstudy.evolution.stability.adaptive_steps`). For `dsmc`, collisions are counted
        along the law of cooling.

    Raises
    ------
    ValueError
        For a bad scene, solver or time, a tolerance out of reach, or `dsmc` without times.
    """
    if (t_final is None) != (dt is None and time_rtol is None):
        raise ValueError(f"t_final={t_final!r}, dt={dt!r}: give both, or neither")
    settings = None
    if t_final is not None:
        settings = TimeSettings(t_final, dt, time_rtol, scheme=scheme, frame=frame)
    if not solver.traits.by_particles:
        return _plan_operator(scene, choose(scene, solver), settings)
    if settings is None:
        raise ValueError(
            f"t_final=None: method {solver.method!r} has no evaluation of Q; give t_final and dt"
        )
    return _plan_particles(scene, solver.sized(), settings)


def expected_evaluations(scene: Scene, solver: SizedSolver, settings: TimeSettings) -> int:
    """Evaluations of Q in a run: exact where dt is given, else an estimate (`adaptive_steps`)."""
    scheme, steps = SCHEMES[settings.scheme], expected_steps(scene, solver, settings)
    if not _outputs_inside(settings):
        return scheme.evaluations * steps
    return 1 + (scheme.evaluations - 1) * steps  # the last rate of a step is the first of the next


def expected_steps(scene: Scene, solver: SizedSolver, settings: TimeSettings) -> int:
    """Steps of a run: exact where dt is given, else an estimate (`adaptive_steps`)."""
    if settings.time_rtol is None:
        return settings.steps
    grid: VelocitySpace = (
        RadialGrid(scene.dim, solver.N, solver.R)
        if solver.traits.radial
        else solver.grid(scene.dim)
    )
    # Steps end at outputs, unless these lie inside them.
    ends = 1 if _outputs_inside(settings) else len(settings.outputs)
    return ends + adaptive_steps(
        scene,
        grid,
        settings.scheme,
        settings.time_rtol,
        settings.t_final,
        rescaled=settings.rescaled,
    )


def _outputs_inside(settings: TimeSettings) -> bool:
    """Whether outputs lie inside steps."""
    return settings.time_rtol is not None and SCHEMES[settings.scheme].interpolation_error > 0.0


class Beside(NamedTuple):
    """What a run does beside the evaluations that its steps make.

    ``seconds`` are those of states looked at, ``evaluations`` are those of checks.
    """

    seconds: float
    evaluations: int


def expected_beside(
    scene: Scene, solver: SizedSolver, settings: TimeSettings, evaluations: int
) -> Beside:
    """What a run with so many evaluations does beside them: records, balances, checks of the quadrature."""
    outputs_inside = _outputs_inside(settings)
    steps = max(1, evaluations // (SCHEMES[settings.scheme].evaluations - outputs_inside))
    outputs = len(settings.outputs)
    balances = min(steps, BALANCES + 1)
    seconds = SETUP_SECONDS + steps * SECONDS_PER_STEP + outputs * SECONDS_PER_OUTPUT
    further = 0 if outputs_inside else balances  # steps of other schemes leave no rate of their end
    if not solver.traits.radial:
        points = solver.N**scene.dim
        seconds += steps * points * SECONDS_PER_STEP_POINT
        seconds += outputs * points * SECONDS_PER_OUTPUT_POINT
        seconds += (balances + 4) * 2**scene.dim * points * SECONDS_PER_BALANCE_POINT
        if settings.rescaled:
            seconds += evaluations * points * SECONDS_PER_FRAME_POINT
    if solver.rtol is not None and not solver.traits.radial:
        # A tolerance is checked now and then by a finer quadrature, at about a step's time.
        pace = LONG_STEP if outputs_inside else 1
        further += math.ceil(3 * (1 + pace * steps / CHECK_EVERY))
    return Beside(seconds, further)


def evolution_cost(cost: Cost, scene: Scene, solver: SizedSolver, settings: TimeSettings) -> Cost:
    """The cost of a run, out of the cost of its evaluations."""
    beside = expected_beside(scene, solver, settings, cost.evaluations)
    setup, each = cost.setup, cost.each
    if callable(scene.restitution) and settings.rescaled:  # Q is interpolated between operators
        setup, each = setup * OPERATORS_OF_A_LAW, each * OPERATORS_OF_A_LAW
    return replace(cost, setup=setup + beside.seconds + beside.evaluations * each, each=each)


def _plan_operator(scene: Scene, choice: Choice, settings: TimeSettings | None) -> Forecast:
    """Forecast of a run on a grid, or of one evaluation where there are no settings."""
    solver, method = choice.solver, OPERATORS[choice.solver.method].cost
    check_restitution(scene.restitution, largest_speed=solver.R)
    count = _count(scene, solver, method)
    one_thread = method.seconds(scene, solver, count.transforms, count.n)
    threads = solver.thread_count
    cost = Cost(
        setup=on_threads(method.setup(scene, solver, one_thread), method.efficiency, threads),
        each=on_threads(one_thread, method.efficiency, threads),
        evaluations=1 if settings is None else expected_evaluations(scene, solver, settings),
        memory_mb=memory_mb(method.numbers(scene, solver, count.transforms)),
        kept=method.kept(scene, solver),
    )
    if settings is not None:
        cost = evolution_cost(cost, scene, solver, settings)
    reasons = [choice.reason, NOT_TIMED if solver.device == "gpu" else ""]
    return Forecast(
        method=solver.method,
        reason="; ".join(filter(None, reasons)),
        dim=scene.dim,
        N=solver.N,
        R=float(solver.R),
        nodes=count.nodes,
        transforms=count.transforms,
        n=count.n,
        threads=threads,
        seconds_per_evaluation=cost.each,
        evaluations=cost.evaluations,
        seconds=cost.seconds,
        memory_mb=cost.memory_mb,
        error=count.plan.error if count.plan else None,
        plan=count.plan,
        frame="fixed" if settings is None else settings.frame,
    )


def _plan_particles(scene: Scene, solver: SizedSolver, settings: TimeSettings) -> Forecast:
    """Forecast of a run by particles."""
    alpha_table(scene.restitution, solver.R)  # checks the restitution
    cost, collisions = particle_cost(scene, solver, settings.t_final, len(settings.recorded))
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
    """Nodes, transforms and points a dimension of an evaluation; and its quadrature where one is planned."""

    nodes: int
    transforms: int
    n: int
    plan: QuadraturePlan | None = None


def _count(scene: Scene, solver: SizedSolver, cost: MethodCost) -> _Count:
    """Nodes and transforms of an evaluation; where only the operator knows them, it is made."""
    solver = replace(solver, device="cpu")  # the same sums, known without a GPU
    if cost.exact(solver):
        n = solver.product_points
        return _Count(cost.nodes(scene, solver), cost.transforms(scene, solver), n)
    operator = collision_operator(scene, solver)
    if isinstance(operator, TunedOperator):
        plan = operator.plan
        return _Count(plan.nodes, operator.transforms, plan.n, plan)
    return _Count(operator.transforms // 2 - 1, operator.transforms, solver.N)
