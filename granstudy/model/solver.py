"""Solver: the grid, the quadrature and the method that a scene is modelled with."""

import dataclasses
import math
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from granstudy.model.methods import (
    ACCURACIES,
    METHODS,
    ONLY_SOME,
    PARTICLES,
    PRODUCTS,
    QUADRATURE,
    Method,
    accuracies,
    check_particle_fields,
    that_take,
)
from granstudy.support.checks import check_count, is_count, is_real, plain
from granstudy.support.errors import unknown_name
from granstudy.support.files import file_digest
from granstudy.support.machine import cores
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import check_node_count, check_point_count, check_radius

VARIANTS = ("full", "separate")
SPHERE_RULES = ("design", "lebedev", "product", "gauss-theta-phi")
RADIAL_RULES = ("legendre", "jacobi")
PRECISIONS = ("double", "single")
DEVICES = ("cpu", "gpu")

NOT_IN_USE = {"dealias": False, "precision": PRECISIONS[0], "device": DEVICES[0]}
"""Values of the fields of `PRODUCTS` that a solver's description leaves out."""

REAL = ("R", "rtol")
"""Fields that are real numbers: 7 and 7.0 are one value."""


def setting(default: Any, text: str) -> Any:
    """A field of `Solver`, with its explanation in the schema of study files."""
    return dataclasses.field(default=default, metadata={"help": text})


@dataclass(frozen=True, eq=False)
class Solver:
    """The grid, the quadrature and the method that a scene is modelled with.

    Defaults are the paper's. A field that the method does not take keeps its default
    (`granstudy.model.methods`).

    Attributes
    ----------
    N : int or None
        Points of the grid in each dimension, an even number. For `radial`: the number of speeds; N speeds
        resolve what 1.7 N Cartesian points in each dimension do.
    R : float or None
        Truncation radius of the relative velocity. With ``rtol``, N and R may both be None: they are then
        chosen for the scene's initial density (`granstudy.fit_solver`).
    N_rho : int or None
        Radial nodes of the quadrature. None, for `direct` only: as many as the integral needs to converge.
    M_sph : int or pair of int
        Nodes on the sphere, in 3D; the rule ``gauss-theta-phi`` takes a pair (N_theta, N_phi).
    M_cir : int
        Nodes on the circle, in 2D.
    variant : str
        ``full``: gain and loss by the same nodes. ``separate``: the loss in closed form.
    method : str
        One of

        ============  ==============================================================================
        ``auto``      the cheapest method that can do the scene (`granstudy.choose`); N counts
                      Cartesian points, whatever is chosen
        ``literal``   the paper's recipe, every node of it
        ``direct``    the sum over all pairs of modes, O(N^{2d}): a reference
        ``fast``      the paper's sum over nodes, made fast
        ``radial``    isotropic densities and constant e only
        ``carleman``  elastic and near-elastic scenes only
        ``dsmc``      particles; no operator, `granstudy.simulate` only. N and R give the cells and
                      the box that velocities are drawn on
        ============  ==============================================================================

    sphere_rule : str
        ``design``, ``lebedev``, ``product``, ``gauss-theta-phi``, or the path of a text file of unit vectors.
        The content of such a file belongs to the solver: two solvers with different contents are not equal,
        and a file that changes after the solver was made is refused.
    radial_rule : str
        ``legendre`` (the paper's) or ``jacobi`` (spectral at every λ).
    rtol : float or None
        For `fast` and `auto`: tolerance in (0, 1) of the quadrature error of Q, over max|Q|; near an
        equilibrium, where Q vanishes, over a hundredth of the loss. Errors of the mass, momentum and energy
        of Q are held to half of rtol, over the same of |Q|. The shells, and the rule of each, are then chosen
        for the scene; N_rho, M_sph, M_cir, sphere_rule and radial_rule keep their defaults. For `radial`,
        which has no such error, rtol chooses N and R alone.
    circular : bool
        For `direct`: the paper's direct method to its digits. l + m wraps around the spectrum, as products
        on a grid do, and sinc is evaluated as in the paper's code.
    particles : int or None
        For `dsmc`, which needs it: particles of all batches together, a multiple of ``batches``.
    batches : int
        For `dsmc`: independent batches, at least 2; the spread between them gives standard errors.
    seed : int
        For `dsmc`: seed of the random numbers. The same seed gives the same bytes.
    dealias : bool
        For `fast` and `auto`: whether products are formed on 3N/2 points a dimension, so that nothing wraps
        around the spectrum. An evaluation takes about five times as long (N = 32 in 3D).
    precision : str
        For `fast` and `auto`: ``double``, or ``single`` for the transforms and loops of the gain. Single
        precision is about twice as fast, with a round-off of some 1e-7 of max|Q⁺|.
    threads : int or None
        Threads to use; None: one a core. Results do not depend on the number.
    device : str
        For `fast` and `auto`: ``cpu``, or ``gpu`` for the sum over nodes. A GPU needs CuPy or PyTorch (``pip
        install 'granstudy[gpu]'``) and a constant restitution; results differ by round-off.
    accuracy, a2_accuracy : float or None
        In place of all other fields: largest errors of T, relative, and of a2. A run then chooses everything,
        and chooses again while it goes on; a2_accuracy is 10 times accuracy where it is None.

    Raises
    ------
    ValueError
        If a field has another value, or the method does not take it; the message says field, value and
        what is allowed.
    """

    N: int | None = setting(None, "grid points in each dimension; radial: speeds")
    R: float | None = setting(None, "truncation radius of the relative velocity")
    N_rho: int | None = setting(30, "radial nodes of the quadrature")
    M_sph: int | tuple[int, int] = setting(32, "nodes on the sphere, 3D")
    M_cir: int = setting(30, "nodes on the circle, 2D")
    variant: str = setting("separate", "full or separate: the loss by the gain's nodes, or closed")
    method: str = setting("fast", ", ".join(METHODS))
    sphere_rule: str = setting(
        "design", "design, lebedev, product, gauss-theta-phi, or a text file"
    )
    radial_rule: str = setting("legendre", "legendre or jacobi")
    rtol: float | None = setting(None, "tolerance of Q's quadrature error, in place of N_rho, M_..")
    circular: bool = setting(False, "direct: do as the paper's direct method does")
    particles: int | None = setting(None, "of method dsmc, all batches together")
    batches: int = setting(20, "of method dsmc; default 20")
    seed: int = setting(0, "of method dsmc; default 0")
    dealias: bool = setting(False, "pad the products of fast")
    precision: str = setting("double", "double, or single for fast")
    threads: int | None = setting(None, "threads to use; default: one a core")
    device: str = setting("cpu", "cpu or gpu; default: cpu")
    accuracy: float | None = setting(None, "accuracy of T, in place of all else")
    a2_accuracy: float | None = setting(None, "accuracy of a2; default 10 times that of T")

    _sphere_rule_sha256: ClassVar[str | None]  # no field: it follows from one

    def __post_init__(self) -> None:
        self._make_plain()
        for field, allowed in (
            ("variant", VARIANTS),
            ("method", tuple(METHODS)),
            ("radial_rule", RADIAL_RULES),
            ("precision", PRECISIONS),
            ("device", DEVICES),
        ):
            value = getattr(self, field)
            if not isinstance(value, str) or value not in allowed:
                raise unknown_name(field, getattr(self, field), allowed)
        self._check_grid()
        self._check_sizes()
        self._check_only_some()
        if self.rtol is not None:
            self._check_rtol(self.rtol)
        if self.traits.by_particles:
            check_particle_fields(self.particles, self.batches, self.seed)
        named = self.sphere_rule in SPHERE_RULES
        digest = None if named else file_digest(self.sphere_rule)
        object.__setattr__(self, "_sphere_rule_sha256", digest)

    def _make_plain(self) -> None:
        """Keep numbers of NumPy as numbers of Python, R and rtol as floats, a pair of nodes as a tuple."""
        for name, _ in _defaults():
            given = getattr(self, name)
            if isinstance(given, np.ndarray):
                raise ValueError(f"{name}={given!r}: must be one value, not an array")
            value = plain(given)
            if name in REAL and is_real(value):
                value = float(value)
            elif name == "M_sph" and isinstance(value, list | tuple):
                value = tuple(plain(each) for each in value)
            if value is not given:
                object.__setattr__(self, name, value)

    def _check_grid(self) -> None:
        """Raise ValueError unless N and R are both good, or both open and a tolerance chooses them."""
        if self.accuracy is not None or self.a2_accuracy is not None:
            for name, value in accuracies(self._values(), _defaults()).items():
                object.__setattr__(self, name, value)
            return
        if self.N is not None and self.R is not None:
            (check_node_count if self.traits.radial else check_point_count)(self.N)
            check_radius(self.R)
            return
        for field, value in (("N", self.N), ("R", self.R)):
            if value is None and self.rtol is None:
                raise ValueError(
                    f"{field}=None: only with rtol is it chosen; give {field}, or rtol"
                )
        if self.N is not None or self.R is not None:
            raise ValueError(f"N={self.N!r}, R={self.R!r}: rtol chooses both; give both or neither")

    def _check_sizes(self) -> None:
        """Raise ValueError for a bad number of nodes or threads, or a bad dealias."""
        if self.N_rho is not None:
            check_count("N_rho", self.N_rho)
        elif not self.traits.free_radii:
            allowed = next(name for name, method in METHODS.items() if method.free_radii)
            raise ValueError(f"N_rho=None: only method {allowed!r} allows it, not {self.method!r}")
        check_count("M_cir", self.M_cir)
        if not isinstance(self.M_sph, tuple):
            check_count("M_sph", self.M_sph)
        elif len(self.M_sph) != 2 or not all(map(is_count, self.M_sph)):
            raise ValueError(
                f"M_sph={self.M_sph!r}: must be a positive integer, or a pair of them (N_theta, N_phi)"
            )
        if self.threads is not None:
            check_count("threads", self.threads)
        for field in ("dealias", "circular"):
            if not isinstance(getattr(self, field), bool):
                raise ValueError(f"{field}={getattr(self, field)!r}: must be True or False")
        if not isinstance(self.sphere_rule, str):
            raise ValueError(
                f"sphere_rule={self.sphere_rule!r}: must be the name of a rule or the path of a file"
            )

    def _check_only_some(self) -> None:
        """Raise ValueError for a field that only other methods take."""
        takes = self.traits.takes
        for name, default in _defaults():
            value = getattr(self, name)
            if name in ONLY_SOME and name not in takes and value != default:
                raise ValueError(
                    f"{name}={value!r}: only {that_take(name)} it, not {self.method!r}"
                )

    def _check_rtol(self, rtol: object) -> None:
        """Raise ValueError for a bad tolerance, or one beside a field that it chooses."""
        if not is_real(rtol) or not 0.0 < rtol < 1.0:
            raise ValueError(f"rtol={rtol!r}: must be a number between 0 and 1, or None")
        for name, default in _defaults():
            value = getattr(self, name)
            if name in QUADRATURE and value != default:
                raise ValueError(
                    f"{name}={value!r}: rtol={rtol!r} chooses it; leave one of them out"
                )

    def __eq__(self, other: object) -> bool:
        """Whether fields and the rule's file are equal; a `SizedSolver` may equal a `Solver`."""
        if not isinstance(other, Solver):
            return False
        mine, others = ((one._values(), one.sphere_rule_sha256) for one in (self, other))
        return mine == others

    def __hash__(self) -> int:
        return hash((self._values(), self.sphere_rule_sha256))

    @property
    def sphere_rule_sha256(self) -> str | None:
        """SHA-256 of the file of directions, as it was when the solver was made; None for a rule with a name.

        None too where there was no such file.
        """
        return self._sphere_rule_sha256

    def _values(self) -> tuple[Any, ...]:
        return tuple(getattr(self, name) for name, _ in _defaults())

    @property
    def traits(self) -> Method:
        """The traits of the method."""
        return METHODS[self.method]

    @property
    def is_open(self) -> bool:
        """Whether the method, or the grid, is yet to be chosen for a scene."""
        return self.traits.chooses or self.N is None

    def sized(self) -> "SizedSolver":
        """The solver with N and R known to type checkers.

        Raises
        ------
        ValueError
            If N and R are left open.
        """
        if self.N is None:
            raise ValueError("N=None: choose N and R first, with granstudy.choose")
        sized = SizedSolver(*self._values())
        object.__setattr__(sized, "_sphere_rule_sha256", self._sphere_rule_sha256)
        return sized

    def grid(self, dim: int) -> VelocityGrid:
        """The Cartesian grid in ``dim`` dimensions; method `radial` has another one (`RadialGrid`)."""
        sized = self.sized()
        return VelocityGrid(dim, sized.N, sized.R)

    @property
    def thread_count(self) -> int:
        """Threads to use."""
        return self.threads or cores()

    def coordinates(self, dim: int) -> dict[str, Any]:
        """The solver's parameters that a study sweeps and that play a part.

        Keys are the names of `granstudy.datasets.parameters`; values that a run lacks are left out.
        """
        if self.accuracy is not None:
            return {"accuracy": self.accuracy, "a2_accuracy": self.a2_accuracy}
        grid: dict[str, Any] = {"N": self.N, "R": self.R}
        if self.traits.by_particles:
            sizes = {"particles": self.particles, "batches": self.batches, "seed": self.seed}
            return grid | sizes | {"method": self.method}
        rules: dict[str, Any] = {}
        if self.rtol is None:
            rules = {"sphere_rule": self.sphere_rule} if dim == 3 else {}
            rules["radial_rule"] = self.radial_rule
        device = {"device": self.device} if self.device != DEVICES[0] else {}
        return {
            **grid,
            **self._quadrature_coordinates(dim),
            "variant": self.variant,
            "method": self.method,
            **rules,
            "dealias": self.dealias,
            "precision": self.precision,
            **device,
        }

    def _quadrature_coordinates(self, dim: int) -> dict[str, Any]:
        """The tolerance; without one, the numbers of nodes."""
        if self.rtol is not None:
            return {"rtol": float(self.rtol)}
        N_rho = -1 if self.N_rho is None else self.N_rho
        if dim == 2:
            return {"N_rho": N_rho, "M_cir": self.M_cir}
        if isinstance(self.M_sph, int):
            return {"N_rho": N_rho, "M_sph": self.M_sph}
        N_theta, N_phi = self.M_sph
        return {"N_rho": N_rho, "M_sph": N_theta * N_phi, "N_theta": N_theta, "N_phi": N_phi}

    def describe(self) -> dict[str, Any]:
        """The solver as plain data, for a dataset's attributes.

        Only fields that decide the result are described, and of a file of directions its content by
        ``sphere_rule_sha256``. Left out are ``threads``; the fields that
        ``rtol`` chooses, or ``rtol`` where it is None; fields of particles, or of quadrature, for methods
        without them; and the fields of `PRODUCTS` that are not in use.
        """
        every = {name: getattr(self, name) for name, _ in _defaults()}
        asked = {name: every.pop(name) for name in ACCURACIES}
        if self.accuracy is not None:
            return asked
        unused = {"threads", *({"rtol"} if self.rtol is None else QUADRATURE)}
        unused |= {name for name in PRODUCTS if every[name] == NOT_IN_USE[name]}
        unused |= self.traits.unused if self.traits.by_particles else PARTICLES
        described = {key: value for key, value in every.items() if key not in unused}
        if "sphere_rule" in described and self.sphere_rule_sha256 is not None:
            described["sphere_rule_sha256"] = self.sphere_rule_sha256
        return described


@cache
def _defaults() -> tuple[tuple[str, Any], ...]:
    """Name and default of every field of `Solver`, listed once: solvers are made by the thousand."""
    return tuple((field.name, field.default) for field in dataclasses.fields(Solver))


@dataclass(frozen=True, eq=False)
class SizedSolver(Solver):
    """A `Solver` whose N and R are known: every operator needs them."""

    N: int
    R: float

    def sized(self) -> "SizedSolver":
        """The solver itself."""
        return self

    @property
    def product_points(self) -> int:
        """Points a dimension on which `fast` forms products: N, or with ``dealias`` 3N/2, made even.

        A product of two spectra has modes up to N. On 3N/2 points, modes that wrap around land at N/2 and
        beyond, and those modes are dropped.
        """
        return 2 * math.ceil(3 * self.N / 4) if self.dealias else self.N
