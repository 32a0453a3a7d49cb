"""What each method takes of a solver and leaves unused: one row a method, by its name in study files.

The module is a fork: a new row changes no run of another method (`granstudy.support.fingerprint`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from granstudy.support.checks import check_count, is_real

QUADRATURE = frozenset({"N_rho", "M_sph", "M_cir", "sphere_rule", "radial_rule"})
"""Fields of the quadrature in g: its nodes and rules. A tolerance chooses them."""

PARTICLES = frozenset({"particles", "batches", "seed"})
"""Fields of a simulation by particles."""

PRODUCTS = frozenset({"dealias", "precision", "device"})
"""Fields that say how the products of a sum over nodes are formed, and where."""

ACCURACIES = ("accuracy", "a2_accuracy")
"""Fields that ask for an accuracy of T and of a2."""

A2_OVER_TEMPERATURE = 10.0
"""Accuracy of a2 over that of the temperature, where only one is given."""

FINEST, COARSEST = 1e-10, 0.1
"""Accuracies that can be asked for: estimates of errors are of first order, and see ten digits at most."""

BESIDE_ACCURACY = (*ACCURACIES, "threads", "method")
"""Fields that a solver which asks for an accuracy may have."""

LEAST_PARTICLES = 10
"""Smallest number of particles in a batch of `dsmc`: the covariance of fewer says little."""

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


def accuracies(values: Sequence[Any], defaults: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """The accuracies of T and a2 that a solver asks for, both, and the method `auto`.

    Parameters
    ----------
    values : sequence
        Values of all fields of the solver.
    defaults : sequence of (str, value)
        Their names and defaults.

    Raises
    ------
    ValueError
        If an accuracy is none, or another field is set beside it.
    """
    fields = {name: value for (name, _), value in zip(defaults, values, strict=True)}
    asked = {name: fields[name] for name in ACCURACIES if fields[name] is not None}
    for name, value in asked.items():
        if not is_real(value) or not FINEST <= value <= COARSEST:
            allowed = f"a number between {FINEST:g} and {COARSEST:g}"
            raise ValueError(f"{name}={value!r}: must be {allowed}")
    for name, default in defaults:
        if name not in BESIDE_ACCURACY and fields[name] != default:
            raise ValueError(
                f"{name}={fields[name]!r}: not beside accuracy, which chooses it; leave one of them out"
            )
    if fields["method"] not in ("fast", "auto"):
        raise ValueError(f"method={fields['method']!r}: not beside accuracy, which chooses it")
    T, a2 = (asked.get(name) for name in ACCURACIES)
    if a2 is None:
        a2 = min(A2_OVER_TEMPERATURE * asked["accuracy"], COARSEST)
    if T is None:
        T = max(a2 / A2_OVER_TEMPERATURE, FINEST)
    return {"accuracy": float(T), "a2_accuracy": float(a2), "method": "auto"}


def check_particle_fields(particles: object, batches: Any, seed: object) -> None:
    """Raise ValueError for bad numbers of particles or batches, or a bad seed."""
    check_count("particles", particles)
    check_count("batches", batches)
    assert isinstance(particles, int)
    if batches < 2:
        raise ValueError(f"batches={batches!r}: must be at least 2, for standard errors")
    if particles % batches or particles < LEAST_PARTICLES * batches:
        raise ValueError(
            f"particles={particles!r}: must be a multiple of batches={batches}, at least "
            f"{LEAST_PARTICLES * batches}"
        )
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise ValueError(f"seed={seed!r}: must be an integer of at least 0")


def that_take(field: str) -> str:
    """The methods that take a field, in the words of a message: ``methods 'auto' and 'fast' take``."""
    names = [repr(name) for name, method in METHODS.items() if field in method.takes]
    if len(names) == 1:
        return f"method {names[0]} takes"
    return f"methods {(' and ' if len(names) == 2 else ', ').join(names)} take"
