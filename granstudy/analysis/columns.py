"""Every column of a table, once: heading, symbol, digits, tolerance, long name.

Tables, figures and comparisons read them here. Parameters, which say which run a row is, have their headings
and symbols in `granstudy.datasets.parameters`.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from granstudy.datasets.parameters import PARAMETERS, parameter
from granstudy.support.variables import Variable


@dataclass(frozen=True)
class Tolerance:
    """Largest difference |a − b| ≤ relative·|b| + absolute that is ok, and why; None: not compared."""

    relative: float | None
    absolute: float
    reason: str


CONSTANT = Tolerance(1e-9, 0.0, "a constant of the study")
"""Tolerance of a column that states none."""

Digits = str | Callable[[float], str]
"""A format of Python's, or a function that gives one for a number."""


@dataclass(frozen=True)
class Column:
    """One column: how it is headed, written, compared, described and drawn.

    Attributes
    ----------
    heading : str
        In Markdown; "" stands for the name with spaces for underscores.
    digits : str or callable
        Format of a number in Markdown; a variable's own attribute `format` goes before it.
    tolerance : Tolerance
        How far a regenerated number may lie from the committed one.
    long_name : str
        Long name in NetCDF, where a table computes the column; the table fills in words in braces. "" where
        the variable comes from the runs, which have its long name.
    units : str
        Units in NetCDF of the same columns; "" where the column holds no numbers.
    symbol : str
        On an axis, as Matplotlib's mathematics; "" stands for the name.
    legend : str
        Text below a Markdown table whose quantity it is; "" stands for the long name.
    solved : str
        Format in tables of states, whose numbers are known to more digits; "" stands for `digits`.
    """

    heading: str = ""
    digits: Digits = ".3g"
    tolerance: Tolerance = CONSTANT
    long_name: str = ""
    units: str = "1"
    symbol: str = ""
    legend: str = ""
    solved: str = ""

    def text(self, value: float) -> str:
        """Write a number to the digits that are worth reading."""
        return format(value, self.digits(value) if callable(self.digits) else self.digits)


def _ratio_digits(ratio: float) -> str:
    return ".3f" if 0.01 <= ratio < 1000 else ".1e"


ERROR, ROUGH, SIX = ".3e", ".1e", ".6f"
"""Formats of errors, of errors of which the size alone matters, and of a state's numbers."""

# Tolerances, named after the columns that have them.
RECIPE = Tolerance(
    1e-6, 1e-12, "the recipe is deterministic; FFT and BLAS round-off differ by machine"
)
LIKE_RECIPE = replace(RECIPE, reason="as paper_temperature_error")
T = Tolerance(1e-9, 1e-12, "a moment of order one after some hundred steps")
A2 = Tolerance(1e-6, 1e-8, "a quotient of moments after some hundred adaptive steps")
T_ERROR = Tolerance(
    1e-4, 1e-9, "a difference of moments known to 1e-9; steps that adapt follow round-off"
)
T_ESTIMATE = replace(T_ERROR, reason="as largest_temperature_error")
A2_ERROR = Tolerance(1e-4, 1e-8, "as largest_temperature_error")
Q_ERROR = Tolerance(1e-6, 1e-12, "max|Q| is about 0.1, known to round-off")
Q_RELATIVE = Tolerance(1e-6, 1e-11, "collision_error over max|Q|")
Q_PLANNED = Tolerance(
    1e-6, 1e-11, "collision_error over max|Q|; a tolerance's plan is deterministic"
)
DRIFT = Tolerance(1e-6, 1e-11, "round-off of a sum over the grid")
ORDER = Tolerance(1e-3, 1e-3, "a slope through errors near the round-off of T")
HAFF = Tolerance(1e-7, 0.0, "a fit to smooth data")
HAFF_ERROR = Tolerance(1e-4, 0.0, "a variance of small residuals")
RATIO = Tolerance(1e-6, 1e-5, "a quotient of the above and a printed number")
SECONDS = Tolerance(None, 0.0, "depends on the machine and its load")
RATIOS = replace(SECONDS, reason="a quotient of errors that are compared themselves")
FFT = replace(SECONDS, reason="as seconds")
SPEEDUP = replace(SECONDS, reason="a quotient of seconds on a shared machine")
OVERHEAD = replace(SECONDS, reason="as speedup")
MEMORY = replace(SECONDS, reason="depends on the allocator")
FRONT = replace(SECONDS, reason="follows from seconds")
GROWTH = replace(SECONDS, reason="a slope through seconds")
MEMORY_GROWTH = replace(SECONDS, reason="a slope through peak memories")

SOLVED = Tolerance(
    1e-4, 1e-5, "Newton's method stops at a residual of 1e-9, which a slow tail magnifies"
)
SOLVED_ERROR = Tolerance(
    1e-4, 1e-6, "a2 of a solved state less a law: as a3, and a2 is less sensitive"
)
SOLVED_ESTIMATE = Tolerance(1e-2, 1e-6, "an imbalance of fourth moments near the residual of a3")
REACHED = Tolerance(None, 0.0, "follows from round-off where grids agree better than was asked")
FAR = Tolerance(0.03, 0.0, "seen at the largest speed at which two grids agree to 1 %")
BETWEEN = Tolerance(1e-6, 1e-8, "a difference of two moments known as a2 is")

# fmt: off
OF_QUANTITY: dict[str, Column] = {
    "slope": Column("d ln T/d ln t", SIX, CONSTANT, "d ln T/d ln t, mean over the last decade of t"),
    "slope_error": Column(
        "from −2/λ", ROUGH, CONSTANT, "largest |d ln T/d ln t + 2/λ| in the last decade of t"),
    "C0": Column(
        "C₀", ".5g", HAFF, "Haff constant, least squares of T0 (1 + C0 t)^-2", symbol="$C_0$"),
    "C0_error": Column("± (fit)", ERROR, HAFF_ERROR, "standard error of the fitted C0"),
    "C0_theory": Column(
        "C₀ (Gaussian)", ".5g", CONSTANT,
        "Haff constant of a Gaussian shape at the initial temperature"),
    "as_printed": Column(
        "as printed", ERROR, RECIPE, "{of} times {factor}, as the paper's code prints it"),
    "paper": Column("", "", CONSTANT, "{of} printed in the paper; NaN where has_paper is false"),
    "ratio": Column(
        "ours / paper", _ratio_digits, RATIO, "ours / paper; NaN where has_paper is false"),
    "has_paper": Column(long_name="the paper prints a number for the run", units=""),
    "order": Column(
        "fitted order", ".3g", ORDER,
        "p of {of} ~ {x}^p, fitted to the runs that differ in {x} alone"),
}
"""Columns that stand directly after the table's quantity: fits, and numbers printed in the paper."""

COLUMNS: dict[str, Column] = OF_QUANTITY | {
    # Errors of runs beside a truth, and the runs' own estimates.
    "largest_temperature_error": Column(
        "error of T", ERROR, T_ERROR, "largest |T/T_truth − 1| over the output times reached",
        symbol=r"largest $|T/T_\mathrm{true} - 1|$"),
    "temperature_error_estimate": Column(
        "its estimate", ERROR, T_ESTIMATE,
        "largest relative error of T that the run itself estimated",
        symbol=r"estimated $\Delta T/T$"),
    "largest_a2_error": Column(
        "error of a2", ERROR, A2_ERROR, "largest |a2 − a2_truth| over the output times reached",
        symbol=r"largest $|a_2 - a_{2,\mathrm{true}}|$"),
    "a2_error_estimate": Column(
        "its estimate", ERROR, A2_ERROR, "largest error of a2 that the run itself estimated",
        symbol=r"estimated $\Delta a_2$"),
    "trust": Column(),
    # Errors of Q.
    "collision_error": Column(
        "", ERROR, Q_ERROR, "max|Q − Q_reference| on the grid",
        symbol=r"$\|Q - Q_\mathrm{direct}\|_\infty$"),
    "relative_error": Column(
        "", ERROR, Q_RELATIVE, "max|Q − Q_reference| / max|Q_reference|",
        symbol=r"$\|Q - Q_\mathrm{direct}\|_\infty / \|Q_\mathrm{direct}\|_\infty$"),
    # Evolutions at their last time; the runs have the long names.
    "paper_temperature_error": Column(
        "", ERROR, RECIPE, symbol=r"$|T - T_\mathrm{ref}|$",
        legend="|T − T_ref| at the final time, measured as the paper does: "
        "T = 2E/d, not divided by density; T_ref by the exact law from the discrete initial T"),
    "temperature_error": Column(
        "", ERROR, LIKE_RECIPE, symbol=r"$|T - T_\mathrm{exact}|$",
        legend="|T − T_exact| at the final time, T divided by density"),
    "temperature": Column("", ".5g", T, symbol="$T$", solved=".7f"),
    "a2": Column("", ".3g", A2, symbol="$a_2$", solved=SIX),
    # States, beside theories of them.
    "a2_linear": Column("a2 (linear theory)", SIX, CONSTANT, "a2 by the theory linear in it"),
    "a2_divided": Column(
        "a2 (linear, divided by 1 + a2)", SIX, CONSTANT,
        "a2 by the theory linear in it after division by 1 + a2"),
    "a2_exact": Column(
        "a2 (exact)", SIX, CONSTANT, "a2 by the exact moments of Maxwell molecules"),
    "a2_error": Column(
        "error of a2", ROUGH, SOLVED_ERROR, "|a2 − a2_exact|", symbol="$|a_2 - a_2^{exact}|$"),
    "tail_exponent": Column(
        "p of the tail", ".3g", CONSTANT,
        "p of the exact tail |v|^(−d−p), of which ⟨|v|⁴⟩ beyond V is V^(4−p)"),
    "a3": Column("", SIX, SOLVED, symbol="$a_3$"),
    "cooling_rate": Column(symbol=r"$-\dot T/T$"),
    "cooling_coefficient": Column("K", ".7g", symbol="$K$"),
    "cooling_coefficient_linear": Column(
        "K (linear theory)", ".7g", CONSTANT, "K of a Gaussian with the a2 of linear theory",
        symbol=r"$K_\mathrm{linear}$"),
    "estimated_cooling_coefficient_error": Column("± (relative)", ROUGH, REACHED),
    "cooling_coefficient_error": Column("± (relative)", ROUGH, REACHED),
    "a3_error": Column("error of a3", ROUGH, REACHED),
    "tail_rate": Column("A of the tail", ".6g", SOLVED, symbol="$A$"),
    "tail_rate_error": Column("±", ROUGH, REACHED),
    "far_slope": Column("its slope", ".4g", FAR, symbol=r"$-d\,\ln f/d\,c^q$"),
    "far_slope_error": Column("±", ROUGH, REACHED),
    "far_speed": Column("at c", ".3g", REACHED, symbol="$c$"),
    "estimated_a3_error": Column("error of a3", ROUGH, REACHED),
    "mass_loss": Column(),
    "estimated_a2_error": Column("", ROUGH, SOLVED_ESTIMATE),
    # Benchmarks, whose dataset has the long names; `seconds` of whole runs, too.
    "error": Column(
        "", ERROR, Q_PLANNED, symbol=r"$\|Q - Q_\mathrm{ref}\|_\infty / \|Q_\mathrm{ref}\|_\infty$"),
    "seconds": Column(
        "", ".3g", SECONDS, "wall time of the run, set-up included", "s",
        symbol="time per evaluation of $Q$ (s)"),
    "speedup": Column("baseline / this", ".3g", SPEEDUP),
    "transforms": Column(),
    "fft_seconds": Column("FFT seconds", ".3g", FFT),
    "overhead": Column("seconds / FFT seconds", ".3g", OVERHEAD),
    "peak_memory_mb": Column("peak memory (MB)", ".3g", MEMORY),
    "front": Column(tolerance=FRONT),
    "baseline": Column(),
    "reason": Column(),
    "time_exponent": Column(
        "time: exponent in N", ".3g", GROWTH, "p of seconds ~ N^p, fitted to the runs of a method"),
    "memory_exponent": Column(
        "memory: exponent in N", ".3g", MEMORY_GROWTH,
        "p of peak memory ~ N^p, fitted where it is above {least} MB"),
    "law_exponent": Column(
        "N^(d+1) log N: exponent", ".3g", CONSTANT,
        "p of N^{{d+1}} log N ~ N^p, fitted to the same N"),
    # Further quantities of evolutions.
    "density_drift": Column("", ERROR, DRIFT, symbol=r"$\rho/\rho_0 - 1$"),
    "density": Column(symbol=r"$\rho$"),
    "energy": Column(symbol="$E$"),
    "paper_temperature": Column(symbol="$2E/d$"),
    "minimum": Column(symbol=r"$\min f$"),
    "temperature_exact": Column(),
    "paper_temperature_exact": Column(),
    "mass_drift": Column("", ERROR, symbol=r"$|\rho/\rho_0 - 1|$"),
    "momentum_drift": Column("", ERROR, symbol=r"$|\Delta u|/\sqrt{T}$"),
    "edge": Column(),
    "spectral_tail": Column(),
    "step_ratio": Column(),
    "velocity_scale": Column(symbol=r"$\theta$"),
    "collision_time": Column(symbol=r"$\tau$"),
    "collisions": Column(),
    # Random runs beside their truths.
    "temperature_known_to": Column("T known to", ERROR, T_ESTIMATE),
    "a2_known_to": Column("a2 known to", ERROR, A2_ERROR),
    "temperature_ratio": Column(
        "estimate / error of T", ".3g", RATIOS, "estimated over true error of {of}"),
    "a2_ratio": Column(
        "estimate / error of a2", ".3g", RATIOS, "estimated over true error of {of}"),
    "ended": Column(long_name="whether the run reached its final time", units=""),
    "broken": Column(long_name="the rules that the run breaks", units=""),
    "truth": Column(long_name="what the run is held against", units=""),
    # The map's verdict, and how a run ended.
    "wrong": Column(long_name="whether the label breaks the rule", units=""),
    "status": Column(),
}
"""All columns by the name of their variable, in reading order."""
# fmt: on

DERIVED: dict[str, Column] = {
    "_standard_error": Column(digits=ERROR, solved=ROUGH, long_name="standard error of {of}"),
    "_difference": Column(digits=ROUGH, tolerance=BETWEEN, long_name="{of}, less {own}"),
}
"""Columns whose names are made at run time, by the ending of their name.

``<column>_<experiment>`` holds another experiment's number, with the column's own digits.
``<column>[_<experiment>]_standard_error`` and ``<column>_<experiment>_difference`` stand beside it.
"""


def listed(name: str, beside: Sequence[str] = ()) -> str:
    """Row of `COLUMNS` that a column is, or that its name is made from.

    Parameters
    ----------
    beside : sequence of str
        Other experiments, whose names may stand in a column's.

    Raises
    ------
    ValueError
        If no row fits.
    """
    endings = (*DERIVED, *(f"_{other}" for other in beside))
    base = name
    while base not in COLUMNS:
        ending = next((ending for ending in endings if base.endswith(ending)), None)
        if ending is None:
            raise ValueError(
                f"column {name!r}: has no row in granstudy.analysis.columns.COLUMNS; add one, which "
                "gives it a heading, digits, a tolerance and a place among the others"
            )
        base = base.removesuffix(ending)
    return base


def column(name: str, beside: Sequence[str] = ()) -> Column:
    """Facts of a column, by the rule of `DERIVED` where its name is made at run time.

    Raises
    ------
    ValueError
        If no row of `COLUMNS` has it.
    """
    own = COLUMNS[listed(name, beside)]
    if name in COLUMNS:
        return own
    made = next((made for ending, made in DERIVED.items() if name.endswith(ending)), None)
    return made or Column(digits=own.digits, solved=own.solved)


def computed(name: str, values: Any, beside: Sequence[str] = (), **words: object) -> Variable:
    """A column that a table computes, over ``run``; ``words`` go into its long name."""
    own = column(name, beside)
    about = {"long_name": own.long_name.format(**words), "units": own.units}
    return "run", values, {key: text for key, text in about.items() if text}


def reading_order(
    names: Iterable[str], quantity: str, beside: Sequence[str] = (), as_built: bool = False
) -> list[str]:
    """Sort columns as a reader meets them: quantity, its standard error, `OF_QUANTITY`, the rest, `status`.

    Parameters
    ----------
    names : iterable of str
    quantity : str
        The column that the table is about.
    beside : sequence of str
        Other experiments, whose names may stand in a column's.
    as_built : bool
        Whether the rest keeps its order; by default it gets the order of `COLUMNS`.

    Raises
    ------
    ValueError
        If no row of `COLUMNS` has one of the columns.
    """
    places = {name: place for place, name in enumerate(COLUMNS)}

    def place(name: str) -> tuple[int, int]:
        row = listed(name, beside)
        if name == quantity:
            return 0, 0
        if name == f"{quantity}_standard_error":
            return 0, 1
        if row in OF_QUANTITY:
            return 1, places[row]
        return 3 if row == "status" else 2, 0 if as_built else places[row]

    return sorted(names, key=place)


def parameter_heading(name: str) -> str:
    """Heading of a parameter in Markdown; an argument of the user's own function has its name."""
    return parameter(name).heading or name


def heading(name: str) -> str:
    """Heading of a parameter or a column in Markdown."""
    if name in PARAMETERS:
        return parameter_heading(name)
    own = COLUMNS[name].heading if name in COLUMNS else ""
    return own or name.replace("_", " ")


def symbol(name: str) -> str:
    """Symbol of a parameter or a column on an axis; the name itself where it has none."""
    found = PARAMETERS.get(name) or COLUMNS.get(name)
    return found.symbol or name if found else name


def tolerance(name: str) -> Tolerance:
    """The tolerance of a column, by the rule of `DERIVED` where its name is made at run time.

    A column ``<column>_<experiment>`` has the tolerance of the longest column that its name begins with. A
    parameter is a constant.
    """
    if name in COLUMNS:
        return COLUMNS[name].tolerance
    made = next((own for ending, own in DERIVED.items() if name.endswith(ending)), None)
    if made is not None:
        return made.tolerance
    begins = [column for column in COLUMNS if name.startswith(f"{column}_")]
    return COLUMNS[max(begins, key=len)].tolerance if begins else CONSTANT
