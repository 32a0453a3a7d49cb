"""granstudy: parameter studies of granular gases by the fast Fourier spectral method."""

from granstudy.support.garbage import paused_collection

# Three full searches for garbage took a seventh of the time of these imports, and found none.
with paused_collection():
    from granstudy.collision.choice.grid import fit_solver
    from granstudy.collision.fast.adaptive.plan import QuadraturePlan
    from granstudy.collision.operator import choose, collision_operator
    from granstudy.collision.protocol import CollisionOperator
    from granstudy.datasets.netcdf import read_dataset, write_dataset
    from granstudy.datasets.open_runs import final_values, open_runs
    from granstudy.datasets.unstack import unstack_runs
    from granstudy.evolution.forecast import Forecast, plan
    from granstudy.evolution.frames.physical import physical_density
    from granstudy.evolution.simulate import simulate
    from granstudy.evolution.stability import stability_limit
    from granstudy.model.kernel import VHS, hard_spheres, maxwell
    from granstudy.model.load_scene import load_scene
    from granstudy.model.restitution import Viscoelastic
    from granstudy.model.scene import Scene
    from granstudy.model.solver import Choice, Solver
    from granstudy.states.solve import cooling_state, heated_state
    from granstudy.velocity.cartesian import VelocityGrid
    from granstudy.velocity.moments import moments
    from granstudy.velocity.radial import RadialGrid
    from granstudy.velocity.symmetry import Symmetry
    from granstudy.workbench.open_study import OpenStudy, open_study
    from granstudy.workbench.sweep import sweep

__all__ = [
    "VHS",
    "Choice",
    "CollisionOperator",
    "Forecast",
    "OpenStudy",
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
    "open_study",
    "physical_density",
    "plan",
    "read_dataset",
    "simulate",
    "stability_limit",
    "sweep",
    "unstack_runs",
    "write_dataset",
]
