"""Forecasts of runs, by a solver or to an accuracy."""

from granstudy.accuracy.asked import Accuracy, accurate_times
from granstudy.accuracy.setup import prepared
from granstudy.accuracy.simulate import Asked, accuracy_asked
from granstudy.collision.choice.cost import on_threads
from granstudy.collision.choice.methods import OPERATORS
from granstudy.collision.fast.adaptive.plan import TunedOperator
from granstudy.evolution import forecast
from granstudy.evolution.forecast import Forecast
from granstudy.evolution.times import TimeSettings
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.accurate import accurate_cost, beginning
from granstudy.support.machine import memory, one_blas_thread

FEWEST = "the fewest points found on which errors grow no faster than they may"
"""Why a grid was chosen for an accuracy."""


def plan(
    scene: Scene,
    solver: Solver | None = None,
    t_final: float | None = None,
    dt: float | None = None,
    time_rtol: float | None = None,
    scheme: str | None = None,
    frame: str = "fixed",
    *,
    accuracy: Asked = None,
) -> Forecast:
    """Forecast a run of `granstudy.simulate`; by a solver without times, one evaluation of Q.

    What a solver leaves open is chosen, and a tolerance is planned for, as the run would do; a plan takes
    about a second. To an accuracy, the grid is chosen that the run begins with, which takes as long as it
    does there: up to some seconds without isotropy.

    Parameters
    ----------
    scene : Scene
    solver : Solver, optional
    t_final, dt, time_rtol, scheme, frame
        Times as of `granstudy.simulate`; by a solver ``t_final`` comes with ``dt`` or ``time_rtol``, to an
        accuracy it is alone.
    accuracy : float or mapping, optional
        In place of a solver, as of `granstudy.simulate`. Default, without a solver: 1e-3.

    Returns
    -------
    Forecast
        With ``time_rtol`` or an accuracy, the number of steps is an estimate, off by less than a factor 2 in
        119 of 120 runs that were tried (`granstudy.evolution.stability.adaptive_steps`). For `dsmc`,
        collisions are counted along the law of cooling.

    Raises
    ------
    ValueError
        For a bad scene, solver, accuracy or time, a tolerance out of reach, or `dsmc` without times.
    """
    asked = accuracy_asked(solver, accuracy)
    if asked is None:
        assert solver is not None
        return forecast.plan(scene, solver, t_final, dt, time_rtol, scheme, frame)
    if t_final is None:
        raise ValueError(
            "t_final=None: must be given for an accuracy, which is that of a whole run"
        )
    settings = accurate_times(t_final, dt=dt, time_rtol=time_rtol, scheme=scheme, frame=frame)
    return _to_accuracy(scene, asked, settings, None if solver is None else solver.threads)


@one_blas_thread()
def _to_accuracy(
    scene: Scene, asked: Accuracy, settings: TimeSettings, threads: int | None
) -> Forecast:
    """Forecast of a run to an accuracy, which begins as the run would."""
    gas, chooser = prepared(scene, asked, settings.t_final, memory() or float("inf"), threads)
    first = chooser.first()
    solver, operator = first.leg.solver, first.leg.operator
    frame = "rescaled" if gas.rescaled else "fixed"
    begins = beginning(gas.scene, asked, settings.t_final)._replace(solver=solver, frame=frame)
    method = OPERATORS[solver.method].cost
    tuned = operator.plan if isinstance(operator, TunedOperator) else None
    n = solver.N if tuned is None else tuned.n
    each = method.seconds(gas.scene, solver, operator.transforms, n)
    cost, threads = accurate_cost(asked, settings, begins, each), solver.thread_count
    return Forecast(
        method=solver.method,
        reason=first.needed or FEWEST,
        dim=scene.dim,
        N=solver.N,
        R=float(solver.R),
        nodes=0 if tuned is None else tuned.nodes,
        transforms=operator.transforms,
        n=n,
        threads=threads,
        seconds_per_evaluation=on_threads(cost.each, method.efficiency, threads),
        evaluations=cost.evaluations,
        seconds=on_threads(cost.seconds, method.efficiency, threads),
        memory_mb=cost.memory_mb,
        error=None if tuned is None else tuned.error,
        plan=tuned,
        frame=frame,
        accuracy=asked.describe(),
    )
