"""Random gases asked to an accuracy: whether the word was kept, and seconds over the cheapest fixed solver.

``python benchmarks/accuracy.py COUNT [FIRST] [--scan]`` draws COUNT gases from the seed FIRST on. It asks for
1e-2, 1e-4 and 1e-6 of T, 10 times as much of a2, and prints a line a run and a summary:

=========  ===================================================================================
kept       errors of T and a2 against the truth at most what was asked
said       not kept, and the run said that it would miss (attribute ``needed``)
broken     neither
ratio      with --scan: seconds over those of the cheapest fixed solver whose errors are as small
=========  ===================================================================================

The truth is an exact law for Maxwell molecules, else a finer run. A run counts as `uncertain` where it misses
and the estimate of its truth is above half of what was asked. Gases are those of random runs
(`granstudy.runs.labels.cases`), isotropic in 2D and 3D, or without symmetry in 2D.
"""

import argparse
import itertools
import json
import time
import warnings
from collections.abc import Iterator

import numpy as np
import xarray as xr

import granstudy as gs
from granstudy.accuracy.setup import at_rest
from granstudy.accuracy.setup import is_isotropic as isotropic_at_rest
from granstudy.runs.labels.cases import random_case
from granstudy.trust.truth import Errors, Truth, errors, maxwell_truth, truth_of_dataset

ASKED = (1e-2, 1e-4, 1e-6)
"""Accuracies of T that are asked for."""

SPEEDS, RADII = (16, 20, 24, 28, 32, 40, 48), (6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0)
"""Radial grids that the scan tries."""

POINTS, RTOLS = (16, 20, 24, 28, 32, 40, 48), (1e-2, 1e-3, 1e-4, 1e-5)
"""Cartesian grids and tolerances that the scan tries."""

BARS = (0.95, 3.0, 2.0)
"""Share that keeps its word at least; largest error over what was asked; median ratio of seconds at most."""


def gas(seed: int) -> tuple[gs.Scene, float]:
    """The scene of a seed and its final time."""
    case = random_case(seed)
    scene, t_final = case.scene, case.time["t_final"]
    # seen from its bulk velocity, which changes neither T nor a2: fixed solvers need that
    return at_rest(scene)[0], float(t_final) * float(
        np.random.default_rng(seed).choice([1.0, 3.0, 10.0])
    )


def timed(scene: gs.Scene, **words: object) -> tuple[xr.Dataset, float]:
    """A run and its seconds."""
    start = time.perf_counter()
    ds = gs.simulate(scene, progress=False, **words)
    return ds, time.perf_counter() - start


def is_isotropic(ds: xr.Dataset) -> bool:
    """Whether a run began as radial."""
    return bool(ds["leg_radial"].values[0])


def truth(scene: gs.Scene, t_final: float, times: np.ndarray, isotropic: bool) -> Truth:
    """The exact law, or a finer run."""
    by_law = scene.kernel.exponent == 0.0 and not callable(scene.restitution)
    if by_law and scene.moments is not None:
        return maxwell_truth(scene, np.array([0.0, *times, t_final]))
    unit = float(np.sqrt(scene.moments.temperature)) if scene.moments is not None else 1.0
    fixed = callable(scene.restitution) or (scene.restitution == 1.0 and scene.diffusion == 0.0)
    time_words = {"t_final": t_final, "times": times, "frame": "fixed" if fixed else "rescaled"}
    if isotropic:
        solver = gs.Solver(N=64, R=16.0 * unit, method="radial")
        return truth_of_dataset(timed(scene, solver=solver, time_rtol=1e-9, **time_words)[0])
    solver = gs.Solver(N=64, R=12.0 * unit, N_rho=32, M_cir=40)
    return truth_of_dataset(timed(scene, solver=solver, time_rtol=1e-7, **time_words)[0])


def solvers(scene: gs.Scene, isotropic: bool) -> Iterator[tuple[gs.Solver, str, float]]:
    """Fixed solvers, frames and tolerances of steps that a person might try."""
    unit = float(np.sqrt(scene.moments.temperature)) if scene.moments is not None else 1.0
    frames, steps = ("fixed", "rescaled"), (1e-3, 1e-5, 1e-7)
    if isotropic:
        for N, R, frame, rtol in itertools.product(SPEEDS, RADII, frames, steps):
            yield gs.Solver(N=N, R=R * unit, method="radial"), frame, rtol
        return
    for N, R, q, frame in itertools.product(POINTS, RADII, RTOLS, frames):
        yield gs.Solver(N=N, R=R * unit, rtol=q), frame, min(1e-3, q)


def cheapest(
    scene: gs.Scene, t_final: float, times: np.ndarray, true: Truth, isotropic: bool
) -> list[tuple[float, Errors]]:
    """Seconds and errors of all fixed solvers that can do it."""
    found = []
    for solver, frame, rtol in solvers(scene, isotropic):
        words = {"t_final": t_final, "times": times, "time_rtol": rtol, "frame": frame}
        try:
            ds, seconds = timed(scene, solver=solver, **words)
        except ValueError:
            continue
        if int(ds["status"]) == 0:
            found.append((seconds, errors(ds, true)))
    return found


def main() -> None:
    """Draw, ask, compare, sum up."""
    parser = argparse.ArgumentParser()
    parser.add_argument("count", type=int)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--scan", action="store_true")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    kinds: dict[str, int] = dict.fromkeys(("kept", "said", "broken", "uncertain"), 0)
    ratios: list[float] = []
    worst = 0.0
    for seed in range(given.first, given.first + given.count):
        scene, t_final = gas(seed)
        if scene.dim == 3 and not isotropic_at_rest(scene):
            continue  # its truth takes minutes
        times = np.array([0.1, 0.3]) * t_final
        true: Truth | None = None
        scan: list[tuple[float, Errors]] | None = None
        for asked in ASKED:
            ds, seconds = timed(scene, accuracy=asked, t_final=t_final, times=times)
            if true is None:
                true = truth(scene, t_final, times, is_isotropic(ds))
            off, a2 = errors(ds, true), 10 * asked
            factor = max(off.temperature / asked, off.a2 / min(a2, 0.1))
            unsure = max(true.temperature_uncertainty / asked, true.a2_uncertainty / a2)
            kind = "kept" if factor <= 1.0 else "said" if "needed" in ds.attrs else "broken"
            if kind != "kept" and unsure > 0.5:
                kind = "uncertain"
            kinds[kind] += 1
            if kind == "broken":
                worst = max(worst, factor)
            ratio = np.nan
            if given.scan and kind == "kept":
                if scan is None:
                    scan = cheapest(scene, t_final, times, true, is_isotropic(ds))
                able = [s for s, e in scan if e.temperature <= asked and e.a2 <= a2]
                ratio = seconds / min(able) if able else np.nan
                ratios.append(ratio)
            legs = [
                f"{'radial' if r else 'fast'} {n}/{R:.3g}"
                for n, R, r in zip(
                    ds["leg_N"].values, ds["leg_R"].values, ds["leg_radial"].values, strict=True
                )
            ]
            law = scene.restitution if not callable(scene.restitution) else "law"
            print(
                f"{seed:4} {asked:.0e} {kind:9} T {off.temperature:.1e} a2 {off.a2:.1e} said "
                f"{json.loads(ds.attrs['reached'])['temperature']:.1e} "
                f"{json.loads(ds.attrs['reached'])['a2']:.1e} {seconds:6.2f} s ratio {ratio:.2f}  "
                f"d={scene.dim} λ={scene.kernel.exponent:g} e={law} ε={scene.diffusion:g} t={t_final:g}  "
                f"{', '.join(legs)}",
                flush=True,
            )
    sure = kinds["kept"] + kinds["said"] + kinds["broken"]
    print(kinds, f"kept or said {1 - kinds['broken'] / max(sure, 1):.3f}, worst broken {worst:.2g}")
    if ratios:
        print(f"seconds over the cheapest fixed solver: median {np.nanmedian(ratios):.2f}")


if __name__ == "__main__":
    main()
