"""Every parameter of a run, once: its symbol, its heading in tables, its value for runs without it."""

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Parameter:
    """One parameter of a run: a scalar coordinate of its dataset under the parameter's name.

    Attributes
    ----------
    symbol : str
        Symbol on figures, as Matplotlib's mathematics.
    heading : str
        Heading in tables; "" stands for the name itself.
    absent : object
        Value in a dataset of many runs for runs without the parameter; None where every run has it.
    real : bool
        Whether the parameter is a real number, so that 1 in a study file means 1.0.
    follows : bool
        Whether the parameter follows from others, and so cannot be swept.
    """

    symbol: str = ""
    heading: str = ""
    absent: Any = None
    real: bool = False
    follows: bool = False


PARAMETERS: dict[str, Parameter] = {
    "e": Parameter("$e$", absent=math.nan, real=True),
    "exponent": Parameter(r"$\lambda$", "λ", real=True),
    "epsilon": Parameter(r"$\varepsilon$", "ε", real=True),
    "symmetry": Parameter(),
    "N": Parameter("$N$"),
    "R": Parameter("$R$", real=True),
    "N_rho": Parameter(r"$N_\rho$", "N_ρ", absent=-1),
    "M_sph": Parameter(r"$M_\mathrm{sph}$", absent=-1),
    "N_theta": Parameter(heading="N_θ", absent=-1, follows=True),
    "N_phi": Parameter(heading="N_φ", absent=-1, follows=True),
    "M_cir": Parameter(r"$M_\mathrm{cir}$", absent=-1),
    "rtol": Parameter(absent=-1.0, real=True),
    "particles": Parameter(absent=-1),
    "batches": Parameter(absent=-1),
    "seed": Parameter(absent=-1),
    "variant": Parameter(absent=""),
    "method": Parameter(),
    "sphere_rule": Parameter(heading="rule", absent=""),
    "radial_rule": Parameter(absent=""),
    "dealias": Parameter(absent=False),
    "precision": Parameter(absent=""),
    "device": Parameter(absent="cpu"),
    "frame": Parameter(absent=""),
    "scheme": Parameter(absent=""),
    "conserve": Parameter(absent=""),
    "time_rtol": Parameter(absent=-1.0, real=True),
    "dt": Parameter(r"$\Delta t$", "Δt", absent=math.nan, real=True),
}
"""All parameters by the name of their coordinate, in the order of a run's path."""

SWEPT = tuple(name for name, parameter in PARAMETERS.items() if not parameter.follows)
"""Parameters that a study can sweep."""

ABSENT = {name: p.absent for name, p in PARAMETERS.items() if p.absent is not None}
"""Values that stand for a parameter in runs without it, beside runs with it."""
