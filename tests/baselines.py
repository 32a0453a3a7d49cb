"""Committed moments and work of small runs, which no change may move unnoticed.

``python tests/baselines.py`` in the repository writes baselines.json anew, and says what moved.
Commit it with the reason for the move.
"""

import json
import warnings
from pathlib import Path
from typing import NamedTuple

import granstudy as gs

FILE = Path(__file__).with_name("baselines.json")

RADIAL = {"method": "radial", "N": 24, "R": 8.0}
PLANE = {"N": 24, "R": 7.0, "N_rho": 12, "M_cir": 12}
SPACE = {"N": 16, "R": 7.0, "N_rho": 8, "M_sph": 6}
STEPS = {"t_final": 0.5, "dt": 0.1}
ADAPTIVE = {"t_final": 0.5, "time_rtol": 1e-5, "times": [0.25]}


class Case(NamedTuple):
    """A run: its scene's name and fields, its solver's fields or the accuracy asked for, its time."""

    scene: dict
    solver: dict
    time: dict


CASES = {
    "isotropic, rescaled": Case(
        {"name": "maxwellian3d", "exponent": 1.0, "e": 0.5, "diffusion": 0.0},
        RADIAL,
        {"t_final": 50.0, "time_rtol": 1e-6, "frame": "rescaled"},
    ),
    "isotropic, steps": Case({"name": "bkw2d", "e": 0.2}, RADIAL, STEPS),
    "heated, exponential": Case(
        {"name": "maxwellian3d", "exponent": 1.0, "e": 0.8, "diffusion": 0.3},
        RADIAL,
        ADAPTIVE | {"scheme": "exponential"},
    ),
    "literal": Case({"name": "bkw2d", "e": 0.5}, PLANE | {"method": "literal"}, STEPS),
    "direct": Case({"name": "bkw2d", "e": 0.5}, PLANE | {"N": 16, "method": "direct"}, STEPS),
    "fast": Case({"name": "double_well2d", "e": 0.5}, PLANE | {"method": "fast"}, STEPS),
    "fast, single": Case(
        {"name": "double_well2d", "e": 0.5},
        PLANE | {"method": "fast", "precision": "single"},
        STEPS,
    ),
    "fast in 3D": Case({"name": "bkw3d", "e": 0.2}, SPACE | {"method": "fast"}, STEPS),
    "fast, tuned": Case(
        {"name": "double_well2d", "e": 0.5, "exponent": 1.0},
        {"method": "fast", "N": 32, "R": 7.0, "rtol": 1e-2},
        ADAPTIVE,
    ),
    "fast, conserving": Case(
        {"name": "double_well2d", "e": 0.5},
        PLANE | {"method": "fast"},
        ADAPTIVE | {"conserve": ("mass", "momentum", "energy")},
    ),
    "fast, a law": Case(
        {"name": "bkw2d", "restitution": gs.Viscoelastic(0.1), "exponent": 1.0},
        PLANE | {"method": "fast"},
        STEPS,
    ),
    "carleman": Case({"name": "double_well2d", "e": 1.0}, PLANE | {"method": "carleman"}, STEPS),
    "particles": Case(
        {"name": "maxwellian3d", "exponent": 1.0, "e": 0.5, "diffusion": 0.0},
        {"method": "dsmc", "N": 16, "R": 7.0, "particles": 2000, "batches": 4, "seed": 1},
        STEPS,
    ),
}
"""Runs by name: every method, scheme, frame and kind of steps at least once."""

MOMENTS = ("density", "temperature", "a2")

MOMENT_TOLERANCE = {"fast, single": 1e-5}
"""Relative tolerance of moments, where it is not `USUAL`: single precision rounds at 6e-8."""

USUAL = 1e-8
"""Relative tolerance of moments: FFT and BLAS round differently by machine."""

WORK_TOLERANCE = 0.02
"""Relative tolerance of counts of adaptive steps, which follow round-off; transforms are exact."""


def measured(case: Case) -> dict[str, float]:
    """Moments at the end of a run, and its work."""
    scene, solver = gs.load_scene(**case.scene), gs.Solver(**case.solver, threads=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gs.NotTrustedWarning)
        ds = gs.simulate(scene, solver, progress=False, **case.time)
    found = {name: float(ds[name][-1]) for name in MOMENTS}
    if "steps" in ds.attrs:
        found |= json.loads(ds.attrs["steps"])
    if solver.method != "dsmc":
        found["transforms"] = gs.plan(scene, solver).transforms
    return found


def committed() -> dict[str, dict[str, float]]:
    """The committed baselines."""
    return json.loads(FILE.read_text(encoding="utf-8"))


def main() -> None:
    """Write the baselines anew, and say what moved."""
    before = committed() if FILE.is_file() else {}
    now = {name: measured(case) for name, case in CASES.items()}
    for name, found in now.items():
        for quantity, value in found.items():
            old = before.get(name, {}).get(quantity)
            if old != value:
                print(f"{name}: {quantity} {old} -> {value}")
    FILE.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
