"""Every column of a table, once: heading, symbol, digits, and the tolerance it is compared with."""

from dataclasses import dataclass

import xarray as xr

HEADINGS = {
    "N_rho": "N_ρ",
    "epsilon": "ε",
    "exponent": "λ",
    "dt": "Δt",
    "sphere_rule": "rule",
    "N_theta": "N_θ",
    "N_phi": "N_φ",
    "ratio": "ours / paper",
    "paper": "paper",
    "order": "fitted order",
    "C0": "C₀",
    "C0_error": "± (fit)",
    "C0_theory": "C₀ (Gaussian)",
    "density_drift": "density drift",
    "fft_seconds": "FFT seconds",
    "overhead": "seconds / FFT seconds",
    "speedup": "baseline / this",
    "rtol": "rtol",
    "time_exponent": "time: exponent in N",
    "memory_exponent": "memory: exponent in N",
    "law_exponent": "N^(d+1) log N: exponent",
    "largest_temperature_error": "error of T",
    "temperature_error_estimate": "its estimate",
    "largest_a2_error": "error of a2",
    "a2_error_estimate": "its estimate",
    "peak_memory_mb": "peak memory (MB)",
    "cooling_coefficient": "K",
    "a2_linear": "a2 (linear theory)",
    "a2_divided": "a2 (linear, divided by 1 + a2)",
    "a2_exact": "a2 (exact)",
    "a2_error": "error of a2",
    "tail_exponent": "p of the tail",
    "slope": "d ln T/d ln t",
    "slope_error": "from −2/λ",
}
"""What heads a column; the name itself where none is given."""


QUANTITIES = {
    "paper_temperature_error": "|T − T_ref| at the final time, measured as the paper does: "
    "T = 2E/d, not divided by density; T_ref by the exact law from the discrete initial T",
    "temperature_error": "|T − T_exact| at the final time, T divided by density",
}
"""What a quantity is, where its long name is too short for a reader of the table alone."""


def _digits(table: xr.Dataset, name: str, value: float) -> str:
    """The format of a column that has none of its own."""
    measure = table.attrs.get("paper_quantity") if name == "paper" else name
    if str(measure).endswith(("error", "estimate", "drift")):
        return ".3e"
    if name == "ratio":
        return ".3f" if 0.01 <= value < 1000 else ".1e"
    return ".5g" if measure in ("temperature", "C0", "C0_theory") else ".3g"


@dataclass(frozen=True)
class Tolerance:
    """Largest difference |a−b| ≤ relative·|b| + absolute that is ok, and why; None: not compared."""

    relative: float | None
    absolute: float
    reason: str


TOLERANCES = {
    "paper_temperature_error": Tolerance(
        1e-6, 1e-12, "the recipe is deterministic; FFT and BLAS round-off differ by machine"
    ),
    "temperature_error": Tolerance(1e-6, 1e-12, "as paper_temperature_error"),
    "collision_error": Tolerance(1e-6, 1e-12, "max|Q| is about 0.1, known to round-off"),
    "relative_error": Tolerance(1e-6, 1e-11, "collision_error over max|Q|"),
    "error": Tolerance(
        1e-6, 1e-11, "collision_error over max|Q|; a tolerance's plan is deterministic"
    ),
    "temperature": Tolerance(1e-9, 1e-12, "a moment of order one after some hundred steps"),
    "largest_temperature_error": Tolerance(
        1e-4, 1e-9, "a difference of moments known to 1e-9; steps that adapt follow round-off"
    ),
    "largest_a2_error": Tolerance(1e-4, 1e-8, "as largest_temperature_error"),
    "temperature_error_estimate": Tolerance(1e-4, 1e-9, "as largest_temperature_error"),
    "a2_error_estimate": Tolerance(1e-4, 1e-8, "as largest_temperature_error"),
    "a2": Tolerance(1e-6, 1e-8, "a quotient of moments after some hundred adaptive steps"),
    "density_drift": Tolerance(1e-6, 1e-11, "round-off of a sum over the grid"),
    "order": Tolerance(1e-3, 1e-3, "a slope through errors near the round-off of T"),
    "C0": Tolerance(1e-7, 0.0, "a fit to smooth data"),
    "C0_error": Tolerance(1e-4, 0.0, "a variance of small residuals"),
    "ratio": Tolerance(1e-6, 1e-5, "a quotient of the above and a printed number"),
    "seconds": Tolerance(None, 0.0, "depends on the machine and its load"),
    "fft_seconds": Tolerance(None, 0.0, "as seconds"),
    "speedup": Tolerance(None, 0.0, "a quotient of seconds on a shared machine"),
    "overhead": Tolerance(None, 0.0, "as speedup"),
    "peak_memory_mb": Tolerance(None, 0.0, "depends on the allocator"),
    "front": Tolerance(None, 0.0, "follows from seconds"),
    "time_exponent": Tolerance(None, 0.0, "a slope through seconds"),
    "memory_exponent": Tolerance(None, 0.0, "a slope through peak memories"),
}


DEFAULT = Tolerance(1e-9, 0.0, "a constant of the study")


SYMBOLS = {
    "e": "$e$",
    "exponent": r"$\lambda$",
    "epsilon": r"$\varepsilon$",
    "N": "$N$",
    "R": "$R$",
    "N_rho": r"$N_\rho$",
    "M_sph": r"$M_\mathrm{sph}$",
    "M_cir": r"$M_\mathrm{cir}$",
    "dt": r"$\Delta t$",
    "paper_temperature_error": r"$|T - T_\mathrm{ref}|$",
    "temperature_error": r"$|T - T_\mathrm{exact}|$",
    "collision_error": r"$\|Q - Q_\mathrm{direct}\|_\infty$",
    "relative_error": r"$\|Q - Q_\mathrm{direct}\|_\infty / \|Q_\mathrm{direct}\|_\infty$",
    "error": r"$\|Q - Q_\mathrm{ref}\|_\infty / \|Q_\mathrm{ref}\|_\infty$",
    "seconds": "time per evaluation of $Q$ (s)",
}
"""Axis labels: the paper's symbols."""
