"""granstudy: parameter studies of granular gases with the fast Fourier spectral method."""

from granstudy.aggregate import final_values, open_runs, unstack_runs
from granstudy.choice import choose
from granstudy.collision import CollisionOperator, collision_operator
from granstudy.collision.plan import QuadraturePlan
from granstudy.dataset import read_dataset, write_dataset
from granstudy.evolve import simulate
from granstudy.forecast import Forecast, plan
from granstudy.grid import VelocityGrid
from granstudy.kernel import VHS, Viscoelastic, hard_spheres, maxwell
from granstudy.moments import moments
from granstudy.physical import physical_density
from granstudy.radial_grid import RadialGrid
from granstudy.resolution import fit_solver
from granstudy.scene import Scene, load_scene
from granstudy.solver import Choice, Solver
from granstudy.stability import stability_limit
from granstudy.states import cooling_state, heated_state
from granstudy.symmetry import Symmetry

__all__ = [
    "VHS",
    "Choice",
    "CollisionOperator",
    "Forecast",
    "QuadraturePlan",
    "RadialGrid",
    "Scene",
    "Solver",
    "Symmetry",
    "VelocityGrid",
    "Viscoelastic",
    "choose",
    "collision_operator",
    "cooling_state",
    "final_values",
    "fit_solver",
    "hard_spheres",
    "heated_state",
    "load_scene",
    "maxwell",
    "moments",
    "open_runs",
    "physical_density",
    "plan",
    "read_dataset",
    "simulate",
    "stability_limit",
    "unstack_runs",
    "write_dataset",
]
