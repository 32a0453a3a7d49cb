"""What each method takes of a solver and leaves unused: one row a method, by its name in study files.

The module is a fork: a new row changes no run of another method (`granstudy.support.fingerprint`).
"""

from dataclasses import dataclass

QUADRATURE = frozenset({"N_rho", "M_sph", "M_cir", "sphere_rule", "radial_rule"})
"""Fields of the quadrature in g: its nodes and rules. A tolerance chooses them."""

PARTICLES = frozenset({"particles", "batches", "seed"})
"""Fields of a simulation by particles."""

PRODUCTS = frozenset({"dealias", "precision", "device"})
"""Fields that say how the products of a sum over nodes are formed, and where."""

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"
"""Mark of a fork."""


@dataclass(frozen=True)
class Method:
    """What a method takes, and of what kind it is.

    Attributes
    ----------
    takes : set of str
        Fields of `Solver` that this method takes and some others do not.
    unused : set of str
        Fields of `Solver` that play no part in this method.
    radial : bool
        Whether densities live on a `RadialGrid`; N then counts speeds.
    by_particles : bool
        Whether particles are simulated; there is then no collision operator.
    chooses : bool
        Whether the method stands for another one, chosen for the scene.
    free_radii : bool
        Whether ``N_rho=None`` stands for as many radii as the integral needs.
    laws : bool
        Whether restitution may depend on the impact speed.
    dimensions : tuple of int
        Velocity dimensions d of the scenes that it takes.
    """

    takes: frozenset[str] = frozenset()
    unused: frozenset[str] = frozenset()
    radial: bool = False
    by_particles: bool = False
    chooses: bool = False
    free_radii: bool = False
    laws: bool = True
    dimensions: tuple[int, ...] = (2, 3)


METHODS: dict[str, Method] = {
    "auto": Method(takes=PRODUCTS | {"rtol"}, chooses=True),
    "literal": Method(),
    "direct": Method(unused=frozenset({"M_sph", "M_cir", "sphere_rule"}), free_radii=True),
    "fast": Method(takes=PRODUCTS | {"rtol"}),
    "radial": Method(
        takes=frozenset({"rtol"}), unused=QUADRATURE | {"variant"}, radial=True, laws=False
    ),
    "carleman": Method(unused=frozenset({"N_rho", "radial_rule"}), laws=False),
    "dsmc": Method(
        takes=PARTICLES,
        unused=QUADRATURE | PRODUCTS | {"variant", "rtol", "circular"},
        by_particles=True,
    ),
}
"""All methods, in the order in which messages list them."""

YARDSTICK = "literal"
"""The method that speedups are taken over: the paper's recipe, every transform made."""

ONLY_SOME = frozenset().union(*(method.takes for method in METHODS.values()))
"""Fields that only some methods take; in a solver of another method they keep their default."""


def that_take(field: str) -> str:
    """The methods that take a field, in the words of a message: ``methods 'auto' and 'fast' take``."""
    names = [repr(name) for name, method in METHODS.items() if field in method.takes]
    if len(names) == 1:
        return f"method {names[0]} takes"
    return f"methods {(' and ' if len(names) == 2 else ', ').join(names)} take"
