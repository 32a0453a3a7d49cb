"""The collision operator of a scene: its method chosen where that is open, and made.

The module is a fork: it only chooses, so that no run's key depends on it (`granstudy.support.fingerprint`).
"""

from dataclasses import replace

from granstudy.collision.choice.cheapest import choose_method, radial_nodes
from granstudy.collision.choice.grid import fit_solver
from granstudy.collision.choice.methods import maker
from granstudy.collision.fast.gpu.operator import check as check_gpu
from granstudy.collision.protocol import CollisionOperator
from granstudy.model.restitution import check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Choice, Solver

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"


def choose(scene: Scene, solver: Solver) -> Choice:
    """Choose what a solver leaves open: N and R for its tolerance, then the method.

    A solver that leaves nothing open is returned as it is. The choice depends on neither the machine nor
    the threads.

    Raises
    ------
    ValueError
        If no grid of reasonable size holds the scene's density.
    """
    asked, fitted = solver, ""
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
    """`choose`, on a machine that is to compute: a GPU that is asked for must be there.

    Raises
    ------
    ValueError
        As `choose`; and if the solver asks for a GPU and there is none, or none that can model the scene.
    """
    if solver.device == "gpu":  # here, before any work
        check_gpu(scene)
    return choose(scene, solver)


def collision_operator(scene: Scene, solver: Solver) -> CollisionOperator:
    """Plan the collision operator of a scene as the solver's method does it.

    What the solver leaves open, as ``method="auto"`` does, is first chosen (`granstudy.choose`); the kind of
    grid is part of that choice.

    Raises
    ------
    ValueError
        If the scene's restitution leaves [0, 1] at impact speeds up to R, or the quadrature has no
        rule of the size asked for, or its tolerance cannot be reached on the grid, or there is no GPU
        where one is asked for, or the method is ``dsmc``, which has no operator.
    """
    if solver.traits.by_particles:
        raise ValueError(
            f"method={solver.method!r}: particles have no collision operator; simulate with it, or take "
            "another method"
        )
    chosen = concrete(scene, solver).solver
    check_restitution(scene.restitution, largest_speed=chosen.R)
    return maker(chosen)(scene, chosen)
