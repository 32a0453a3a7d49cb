"""The collision operator of a scene: method and grid are chosen where they are open, and it is made.

The module is a fork: it only chooses, and no run's key depends on it (`granstudy.support.fingerprint`).
"""

from dataclasses import replace

from granstudy.collision.choice.cheapest import choose_method, radial_nodes
from granstudy.collision.choice.grid import fit_solver
from granstudy.collision.choice.methods import check_fits, maker
from granstudy.collision.fast.gpu.operator import check as check_gpu
from granstudy.collision.protocol import CollisionOperator
from granstudy.model.choice import Choice
from granstudy.model.restitution import check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"
"""Mark of a fork."""


def choose(scene: Scene, solver: Solver) -> Choice:
    """Choose what a solver leaves open: N and R for its tolerance, then the method.

    The choice is the same on every machine, with any number of threads.

    Parameters
    ----------
    scene : Scene
    solver : Solver
        A solver with ``rtol`` and no N and R, or of method `auto`, or both. Any other is its own choice.

    Returns
    -------
    Choice
        The solver that was chosen, and why.

    Raises
    ------
    ValueError
        If no grid of reasonable size holds the scene's density.
    """
    asked, fitted = solver, ""
    if solver.accuracy is not None:
        raise ValueError(
            f"accuracy={solver.accuracy!r}: runs and states choose their grids for it; one operator needs "
            "N and R, or rtol"
        )
    if solver.N is None:
        assert solver.rtol is not None
        box = fit_solver(scene, solver.rtol, variant=solver.variant, threads=solver.threads).sized()
        solver = replace(solver, N=radial_nodes(box.N) if solver.traits.radial else box.N, R=box.R)
        fitted = f"N={box.N} and R={box.R:g} hold the density to rtol={solver.rtol:g}"
    chosen, reason = solver.sized(), ""
    if solver.traits.chooses:
        chosen, reason = choose_method(scene, chosen)
    return Choice(asked, chosen, "; ".join(part for part in (fitted, reason) if part))


def concrete(scene: Scene, solver: Solver) -> Choice:
    """Choose what a solver leaves open (`choose`), on the machine that will compute.

    Raises
    ------
    ValueError
        If the solver asks for a GPU and there is none, or the GPU cannot model the scene; if memory cannot
        hold the operator, as estimated before anything is made; and as `choose`.
    """
    if solver.device == "gpu":
        check_gpu(scene)
    choice = choose(scene, solver)
    check_fits(scene, choice.solver)
    return choice


def collision_operator(scene: Scene, solver: Solver) -> CollisionOperator:
    """The collision operator of a scene, by the solver's method.

    Method and grid are chosen first where the solver leaves them open (`granstudy.choose`).

    Returns
    -------
    CollisionOperator
        f ↦ Q(f,f), for densities on the operator's ``grid``.

    Raises
    ------
    ValueError
        If the restitution leaves [0, 1] at impact speeds up to R; if there is no quadrature rule of the size
        asked for; if memory cannot hold the operator, as estimated before it is made; if the tolerance cannot
        be reached on the grid; if the GPU asked for is missing; or for the method `dsmc`, which has no
        operator.
    """
    if solver.traits.by_particles:
        raise ValueError(
            f"method={solver.method!r}: particles have no collision operator; simulate with it, or take "
            "another method"
        )
    chosen = concrete(scene, solver).solver
    check_restitution(scene.restitution, largest_speed=chosen.R)
    return maker(chosen)(scene, chosen)
