"""Whether a run of a study can be computed: what would stop it is said before any work."""

from granstudy.collision.choice.methods import check
from granstudy.evolution.times import check_frame
from granstudy.model.restitution import check_restitution
from granstudy.particles.restitution_table import alpha_table
from granstudy.study.estimates import chosen, expected_evaluations, planned_scene
from granstudy.study.kinds import KINDS
from granstudy.study.run import Run


def check_run(run: Run) -> None:
    """Raise ValueError for anything that would stop a run, its reference or its truth later."""
    kind, solver = KINDS[run.model.run], run.solver
    if solver.N is None and kind.needs_size:
        raise ValueError(f"N=None: {run.model.run} runs need N and R")
    kind.check(run)
    expected_evaluations(run)  # t_final must be a whole number of steps
    if solver.traits.by_particles:
        _check_particles(run)
    else:
        _check_operator(run)
    if run.time is not None:
        check_frame(run.scene, chosen(run).solver, run.time)
    if not run.is_reference:
        _check_measures(run)


def _check_particles(run: Run) -> None:
    method = run.solver.method
    if not KINDS[run.model.run].by_particles:
        able = " and ".join(name for name, kind in KINDS.items() if kind.by_particles)
        raise ValueError(
            f"method={method!r}: has no collision operator for {run.model.run} runs, only {able} runs"
        )
    alpha_table(run.scene.restitution, chosen(run).solver.R)


def _check_operator(run: Run) -> None:
    solver = chosen(run).solver
    check_restitution(run.scene.restitution, solver.R)
    # A method that was chosen was chosen for the scene that Q is planned for.
    asked = run.solver.method == solver.method
    check(run.scene if asked else planned_scene(run), solver)


def _check_measures(run: Run) -> None:
    """Check what the run is measured against."""
    if run.has_reference:
        check_run(run.reference)
        if KINDS[run.model.run].shares_nodes:
            _check_nodes(run)
        return
    for truth in run.measured_against:
        try:
            check_run(truth)
        except ValueError as error:
            raise ValueError(f"truth: {error}") from None


def _check_nodes(run: Run) -> None:
    own, other = chosen(run).solver, chosen(run.reference).solver
    if own.traits.radial != other.traits.radial:
        raise ValueError(
            f"method {own.method!r}: has other velocity nodes than its reference's method "
            f"{other.method!r}; a {run.model.run} run and its reference must share them"
        )
