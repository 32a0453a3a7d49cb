"""Speeds of evaluations and of small runs beside a baseline of their group, by pytest-benchmark.

``pytest -n 0 benchmarks/speed.py --benchmark-columns=median`` prints each group with its ratios in brackets,
those to the fastest of it. Only ratios within one group of one call count: the machine is shared.
"""

import pytest

import granstudy as gs

SCENES = {
    "3D, no symmetry": gs.load_scene(
        "maxwellian3d", exponent=1.0, e=0.5, velocity=(0.3, 0.2, 0.1), symmetry="none"
    ),
    "3D, two beams": gs.load_scene("double_well3d", e=0.5),
    "2D, two beams": gs.load_scene("double_well2d", e=0.5),
}

SOLVERS = {
    "literal": {"method": "literal"},
    "fast": {"method": "fast"},
    "fast, rtol = 1e-2": {"method": "fast", "rtol": 1e-2},
}

NODES = {2: {"N_rho": 30, "M_cir": 30}, 3: {"N_rho": 30, "M_sph": 32}}

RUNS = {
    "fixed, steps": {"dt": 0.02},
    "fixed, time_rtol = 1e-6": {"time_rtol": 1e-6},
    "rescaled, time_rtol = 1e-6": {"time_rtol": 1e-6, "frame": "rescaled"},
}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("scene", SCENES)
def test_an_evaluation(scene, solver, benchmark):
    """An evaluation of Q, beside that of the paper's recipe."""
    benchmark.group = f"Q, {scene}, N = 32"
    gas, fields = SCENES[scene], SOLVERS[solver]
    nodes = {} if "rtol" in fields else NODES[gas.dim]
    operator = gs.collision_operator(gas, gs.Solver(N=32, R=7.0, threads=2, **nodes, **fields))
    f = gas.density(operator.grid)
    operator(f)
    benchmark.pedantic(operator, args=(f,), rounds=9)


@pytest.mark.parametrize("time", RUNS)
def test_a_run(time, benchmark):
    """A run of `radial`, by frame and kind of steps."""
    benchmark.group = "isotropic hard spheres to t = 2, N = 32"
    gas = gs.load_scene("maxwellian3d", exponent=1.0, e=0.5, diffusion=0.0)
    solver = gs.Solver(N=32, R=8.0, method="radial")

    def run():
        gs.simulate(gas, solver, t_final=2.0, progress=False, **RUNS[time])

    run()
    benchmark.pedantic(run, rounds=9)
