"""Whether a run of a study can be computed: what would stop it is said before any work."""

from granstudy.collision.choice.methods import check
from granstudy.evolution.times import check_frame
from granstudy.model.restitution import check_restitution
from granstudy.particles.restitution_table import alpha_table
from granstudy.runs.computation import Computation, ladder
from granstudy.runs.estimates import chosen, planned_scene
from granstudy.runs.kinds import KINDS
from granstudy.study.run import Run
from granstudy.study.schema.experiment import EvolutionExperiment
from granstudy.study.sizes import check_estimate, check_size
from granstudy.trust.exact_law import check_maxwell_law


def check_run(run: Run) -> None:
    """Raise ValueError for anything that would stop a run, its reference or its truth later."""
    _check_law(run)
    check_computation(run.computation)
    if not run.is_reference:
        _check_measures(run)


def check_computation(computation: Computation) -> None:
    """Raise ValueError for anything that would stop a run later."""
    if computation.refinement is not None:
        for rung in ladder(computation):
            check_computation(rung)
        return
    for part in KINDS[computation.kind].parts(computation):
        check_computation(part)
    check_size(computation)
    kind, solver = KINDS[computation.kind], computation.solver
    if solver.accuracy is not None and kind.to_accuracy is None:
        able = " and ".join(name for name, one in KINDS.items() if one.to_accuracy is not None)
        raise ValueError(
            f"accuracy={solver.accuracy!r}: only for {able}, not {computation.kind} runs"
        )
    if solver.N is None and kind.needs_size:
        raise ValueError(f"N=None: {computation.kind} runs need N and R")
    kind.check(computation)
    _check_method(computation)
    check_estimate(computation)  # t_final must be a whole number of steps
    if solver.traits.by_particles:
        alpha_table(computation.scene.restitution, chosen(computation).solver.R)
    else:
        _check_operator(computation)
    if computation.time is not None:
        check_frame(computation.scene, chosen(computation).solver, computation.time)


def _check_method(computation: Computation) -> None:
    """Raise ValueError for particles in a run that they cannot do."""
    solver = computation.solver
    if solver.traits.by_particles and not KINDS[computation.kind].by_particles:
        able = " and ".join(name for name, kind in KINDS.items() if kind.by_particles)
        raise ValueError(
            f"method={solver.method!r}: has no collision operator for {computation.kind} runs, only "
            f"{able} runs"
        )


def _check_operator(computation: Computation) -> None:
    solver = chosen(computation).solver
    check_restitution(computation.scene.restitution, solver.R)
    # A method that was chosen was chosen for the scene that Q is planned for.
    asked = computation.solver.method == solver.method
    check(computation.scene if asked else planned_scene(computation), solver)


def _check_law(run: Run) -> None:
    """Raise ValueError unless the exact law holds that the run is held against, if it is one."""
    model = run.model
    if isinstance(model, EvolutionExperiment) and model.truth is not None and model.truth.law:
        check_maxwell_law(run.scene)


def _check_measures(run: Run) -> None:
    """Check what the run is measured against."""
    if run.has_reference:
        check_run(run.reference)
        # Of a benchmark, radial runs alone have a reference with other nodes, which is evaluated on theirs.
        if KINDS[run.computation.kind].shares_nodes or not run.solver.traits.radial:
            _check_nodes(run)
        return
    for truth in run.measured_against:
        try:
            check_run(truth)
        except ValueError as error:
            raise ValueError(f"truth: {error}") from None


def _check_nodes(run: Run) -> None:
    own, other = chosen(run.computation).solver, chosen(run.reference.computation).solver
    if own.traits.radial != other.traits.radial:
        raise ValueError(
            f"method {own.method!r}: has other velocity nodes than its reference's method "
            f"{other.method!r}; a {run.model.run} run and its reference must share them"
        )
    for name in ("N", "R"):
        mine, its = getattr(own, name), getattr(other, name)
        if mine != its:
            raise ValueError(
                f"{name}={mine!r}: the reference has {name}={its!r}; a {run.model.run} run and its reference "
                f"must share their velocity nodes: leave {name} out of the reference"
            )
