"""The fast operator and the adaptive operator with their sums over nodes on a GPU."""

from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.collision.fast.gpu.device import check_scene, find_gpu
from granstudy.collision.fast.gpu.gain import DeviceGainSum, on_found_gpu
from granstudy.collision.fast.nodes import Nodes
from granstudy.collision.fast.operator import NodalOperator, fast_operator
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.velocity.cartesian import VelocityGrid


def check(scene: Scene) -> None:
    """Raise ValueError unless there is a GPU and the sum on it can model the scene."""
    check_scene(scene)
    find_gpu()


def gain_on_gpu(
    scene: Scene, solver: SizedSolver, grid: VelocityGrid, nodes: Nodes
) -> DeviceGainSum:
    """The sum over ``nodes`` on a GPU, in the solver's precision."""
    return on_found_gpu(scene, grid, nodes, solver.precision)


def fast_on_gpu(scene: Scene, solver: SizedSolver) -> NodalOperator:
    """The fast operator with the solver's rule, its sum on a GPU."""
    return fast_operator(scene, solver, gain_on_gpu)


def adaptive_on_gpu(scene: Scene, solver: SizedSolver) -> AdaptiveOperator:
    """The operator tuned to the solver's tolerance, its sum on a GPU. The quadrature is chosen on the CPU."""
    return AdaptiveOperator(scene, solver, gain_on_gpu)
