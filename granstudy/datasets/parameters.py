"""Every parameter of a run, once: its symbol, its heading in tables, its value for runs without it."""

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Parameter:
    """One parameter of a run: a scalar coordinate of its dataset under the parameter's name.

    Attributes
    ----------
    long_name : str
        What it is, in words: the attribute of its coordinate.
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
    units : str
        Its unit; "1" for numbers without one, and for words.
    """

    long_name: str
    symbol: str = ""
    heading: str = ""
    absent: Any = None
    real: bool = False
    follows: bool = False
    units: str = "1"

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of its coordinate; `symbol` is Matplotlib's mathematics."""
        attributes = {"long_name": self.long_name, "units": self.units}
        return attributes | ({"symbol": self.symbol} if self.symbol else {})


PARAMETERS: dict[str, Parameter] = {
    "scene": Parameter("initial density"),
    "e": Parameter("restitution coefficient", "$e$", absent=math.nan, real=True),
    "restitution": Parameter("law of restitution", absent=""),
    "A": Parameter(
        "dissipation constant of viscoelastic spheres", "$A$", absent=math.nan, real=True
    ),
    "exponent": Parameter("exponent of the kernel", r"$\lambda$", "λ", real=True),
    "strength": Parameter("strength of the kernel", r"$C_\lambda$", "C_λ", real=True),
    "diffusion": Parameter("diffusion", r"$\varepsilon$", "ε", real=True),
    "initial_temperature": Parameter(
        "temperature of the initial density", "$T_0$", "T0", absent=math.nan, real=True
    ),
    "initial_velocity": Parameter("bulk velocity of the initial density", "$u_0$", "u0", absent=""),
    "separation": Parameter("distance of the beams", "$s$", absent=math.nan, real=True),
    "tail": Parameter("exponent of the initial tail", "$s$", absent=math.nan, real=True),
    "symmetry": Parameter("symmetry of the initial density"),
    "accuracy": Parameter("accuracy asked of the temperature", absent=math.nan, real=True),
    "a2_accuracy": Parameter("accuracy asked of a2", absent=math.nan, real=True),
    "N": Parameter("grid points in each dimension", "$N$"),
    "R": Parameter("truncation radius of relative velocities", "$R$", real=True),
    "N_rho": Parameter("radial nodes", r"$N_\rho$", "N_ρ", absent=-1),
    "M_sph": Parameter("nodes on the sphere", r"$M_\mathrm{sph}$", absent=-1),
    "N_theta": Parameter("polar nodes on the sphere", heading="N_θ", absent=-1, follows=True),
    "N_phi": Parameter("azimuthal nodes on the sphere", heading="N_φ", absent=-1, follows=True),
    "M_cir": Parameter("nodes on the circle", r"$M_\mathrm{cir}$", absent=-1),
    "rtol": Parameter("tolerance of the quadrature", absent=-1.0, real=True),
    "particles": Parameter("particles of all batches", absent=-1),
    "batches": Parameter("batches of particles", absent=-1),
    "seed": Parameter("seed of the random numbers", absent=-1),
    "variant": Parameter("loss by the gain's nodes (full) or closed (separate)", absent=""),
    "method": Parameter("method"),
    "sphere_rule": Parameter("rule on the sphere", heading="rule", absent=""),
    "radial_rule": Parameter("rule on the radius", absent=""),
    "dealias": Parameter("whether products are padded", absent=False),
    "precision": Parameter("precision", absent=""),
    "device": Parameter("device", absent="cpu"),
    "frame": Parameter("frame of velocities", absent=""),
    "scheme": Parameter("time scheme", absent=""),
    "conserve": Parameter("what is conserved", absent=""),
    "t_final": Parameter("final time", r"$t_\mathrm{final}$", absent=math.nan, real=True),
    "time_rtol": Parameter("tolerance of the time steps", absent=-1.0, real=True),
    "dt": Parameter("time step", r"$\Delta t$", "Δt", absent=math.nan, real=True),
}
"""All parameters by the name of their coordinate, in the order of a run's path."""

ABSENT = {name: p.absent for name, p in PARAMETERS.items() if p.absent is not None}
"""Values that stand for a parameter in runs without it, beside runs with it."""


def parameter(name: str) -> Parameter:
    """The parameter of that name; an argument of the user's own function has its name in words."""
    return PARAMETERS.get(name) or Parameter(name.replace("_", " "))
