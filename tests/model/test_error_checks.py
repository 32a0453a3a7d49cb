"""What wrong input gets: one clear error that names the field, the value and what is allowed."""

import numpy as np
import pytest

import granstudy as gs

GOOD_SOLVER = {"N": 8, "R": 7.0}


@pytest.mark.fault("C7")
@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"N": -8}, "N=-8: must be an even integer of at least 4"),
        ({"N": 9}, "N=9: must be an even integer"),
        ({"N": 8.0}, "N=8.0: must be an even integer"),
        ({"N": [8]}, r"N=\[8\]: must be an even integer"),
        ({"R": -1.0}, "R=-1.0: must be a positive number"),
        ({"N_rho": 0}, "N_rho=0: must be a positive integer"),
        ({"N_rho": None}, "N_rho=None: only method 'direct'"),
        ({"M_sph": "32"}, "M_sph='32': must be a positive integer"),
        ({"M_sph": (6,)}, r"M_sph=\(6,\): must be a positive integer, or a pair"),
        ({"M_sph": (6, 0)}, r"M_sph=\(6, 0\): must be a positive integer, or a pair"),
        ({"R": True}, "R=True: must be a positive number"),
        ({"R": "7"}, "R='7': must be a positive number"),
        ({"N": np.True_}, "N=True: must be an even integer"),
        ({"R": np.array([7.0])}, "R=array.*: must be one value, not an array"),
        ({"circular": "yes", "method": "direct"}, "circular='yes': must be True or False"),
        ({"sphere_rule": [5]}, r"sphere_rule=\[5\]: must be the name of a rule"),
        ({"method": ["fast"]}, "unknown method"),
        ({"rtol": True}, "rtol=True: must be a number"),
        ({"M_cir": 2.5}, "M_cir=2.5: must be a positive integer"),
        ({"threads": 0}, "threads=0: must be a positive integer"),
        ({"variant": "seperate"}, "unknown variant 'seperate' .did you mean 'separate'"),
        ({"method": "quick"}, "unknown method 'quick'.*auto, literal, direct, fast, radial"),
        ({"radial_rule": "simpson"}, "unknown radial_rule 'simpson'"),
        ({"dealias": 1}, "dealias=1: must be True or False"),
        ({"dealias": True, "method": "direct"}, "dealias=True: only methods 'auto' and 'fast'"),
        ({"precision": "half"}, "unknown precision 'half'.*double, single"),
        (
            {"precision": "single", "method": "literal"},
            "precision='single': only methods .auto. and .fast. take",
        ),
        ({"rtol": 0.0}, "rtol=0.0: must be a number between 0 and 1, or None"),
        ({"rtol": 1.0}, "rtol=1.0: must be a number between 0 and 1"),
        ({"rtol": "1e-6"}, "rtol='1e-6': must be a number"),
        (
            {"rtol": 1e-6, "method": "literal"},
            "rtol=1e-06: only methods .auto., .fast., .radial. take",
        ),
        ({"device": "cuda"}, "unknown device 'cuda': allowed are cpu, gpu"),
        (
            {"device": "gpu", "method": "direct"},
            "device='gpu': only methods 'auto' and 'fast' take it, not 'direct'",
        ),
        ({"rtol": 1e-6, "M_sph": 6}, "M_sph=6: rtol=1e-06 chooses it; leave one of them out"),
    ],
)
def test_solver(settings, message):
    with pytest.raises(ValueError, match=message):
        gs.Solver(**GOOD_SOLVER | settings)


@pytest.mark.fault("C7")
@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"restitution": 1.1}, "restitution=1.1: must lie between 0 and 1"),
        ({"restitution": -0.1}, "restitution=-0.1: must lie between 0 and 1"),
        ({"restitution": [0.5]}, r"restitution=\[0.5\]: must be a number"),
        ({"restitution": lambda v: 1 + v}, "must lie between 0 and 1 for impact speeds"),
        ({"restitution": lambda v: 0.5}, "must return an array of the shape"),
        ({"diffusion": -1e-6}, "diffusion=-1e-06: must be a number of at least 0"),
        ({"diffusion": "1e-6"}, "diffusion='1e-6': must be a number"),
        ({"kernel": 1.0}, "kernel=1.0: must be a granstudy.VHS"),
        ({"resitution": 0.5}, "'resitution' .did you mean 'restitution'"),
        ({"temperature": 2.0}, "unknown field of scene 'bkw2d' 'temperature'"),
    ],
)
def test_scene(overrides, message):
    with pytest.raises(ValueError, match=message):
        gs.load_scene("bkw2d", **overrides)


@pytest.mark.parametrize(
    ("symmetry", "message"),
    [
        (
            "octahedral",
            "unknown symmetry 'octahedral'.*none, inversion, reflections, exchange, full",
        ),
        (3, "symmetry=3: must be a granstudy.Symmetry or its name"),
        (gs.Symmetry.named(3, "full"), "has dim 3, the scene 2"),
    ],
)
def test_symmetries(symmetry, message):
    with pytest.raises(ValueError, match=message):
        gs.load_scene("bkw2d", symmetry=symmetry)


@pytest.mark.parametrize("triplet", ["x", "x,x", "x,z", "x,2y", "x,y,z"])
def test_coordinate_triplets(triplet):
    with pytest.raises(ValueError, match="must be the axes x, y in any order"):
        gs.Symmetry.generated(2, triplet)


def test_a_symmetry_that_does_not_hold():
    scene = gs.load_scene("double_well2d", restitution=0.5, symmetry="full")
    with pytest.raises(
        ValueError, match=r"symmetry='full': initial=DoubleWell2D\(\) does not have it"
    ):
        gs.simulate(scene, gs.Solver(N=16, R=8.0), t_final=1.0, dt=0.1)
    # nor may an operator's states lose it
    scene = gs.load_scene("bkw2d", restitution=0.5)
    operator = gs.collision_operator(scene, gs.Solver(N=16, R=8.0, M_cir=16))
    f = scene.density(operator.grid)
    f[3:] += 1e-6 * f[:-3]
    with pytest.raises(ValueError, match="symmetry='full': the density does not have it"):
        operator(f)


def test_unknown_scene():
    with pytest.raises(ValueError, match="unknown scene 'bkw4d' .did you mean 'bkw"):
        gs.load_scene("bkw4d")


@pytest.mark.fault("C7")
@pytest.mark.parametrize(
    ("exponent", "strength"),
    [(1.5, 1.0), (-0.1, 1.0), (0.0, 0.0), ("a", 1), (1, "a"), (True, 1.0), (np.array([1.0]), 1.0)],
)
def test_kernel(exponent, strength):
    with pytest.raises(ValueError, match="exponent=|strength="):
        gs.VHS(exponent, strength)


@pytest.mark.parametrize(
    ("initial", "message"),
    [
        (lambda vx, vy: np.full((8, 8), np.nan), "64 values that are NaN"),
        (lambda vx, vy: vx, r"shape \(8, 1\)"),
        (lambda vx, vy: 0.0 * vx * vy, "no mass"),
        (lambda vx, vy: 1j * vx * vy, "array of real numbers, got type complex128"),
    ],
)
def test_initial_densities(initial, message):
    scene = gs.Scene(dim=2, initial=initial, kernel=gs.maxwell(2), restitution=0.5)
    with pytest.raises(ValueError, match=message):
        gs.simulate(scene, gs.Solver(**GOOD_SOLVER), t_final=1.0, dt=0.1)
