"""Solver: how well a scene is modelled — grid, quadrature, variant, method."""

import dataclasses
import json
import math
import os
from dataclasses import dataclass
from typing import Any

from granstudy.model.methods import (
    METHODS,
    ONLY_SOME,
    PARTICLES,
    PRODUCTS,
    QUADRATURE,
    Method,
    that_take,
)
from granstudy.support.checks import check_count
from granstudy.support.errors import unknown_name
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import check_node_count, check_point_count, check_radius

VARIANTS = ("full", "separate")
RADIAL_RULES = ("legendre", "jacobi")
PRECISIONS = ("double", "single")
DEVICES = ("cpu", "gpu")

LEAST_PARTICLES = 10
"""Smallest number of particles in a batch of `dsmc`: fewer have no covariance to speak of."""


def setting(default: Any, text: str) -> Any:
    """A field of `Solver`, with what a study file's schema says of it."""
    return dataclasses.field(default=default, metadata={"help": text})


@dataclass(frozen=True, eq=False)
class Solver:
    """How well it is modelled.

    Attributes
    ----------
    N : int
        Grid points in each dimension, even; for `radial` the number of radial nodes, which resolve
        what a Cartesian grid of 1.7 N points in each dimension does.
    R : float
        Truncation radius of the relative velocity. Where ``rtol`` is given, N and R may both be left out:
        they are then chosen for the scene's initial density (`granstudy.fit_solver`).
    N_rho : int or None
        Radial nodes; None lets `direct` take as many as the integral needs to converge.
    M_sph, M_cir : int
        Nodes on the sphere (3D) and on the circle (2D); the other one is not used. For the
        ``gauss-theta-phi`` rule M_sph is the pair (N_theta, N_phi).
    variant : str
        ``full``: gain and loss with the same nodes. ``separate``: the loss from its closed form.
    method : str
        ``auto`` (the cheapest one that can do the scene, see `granstudy.choose`; N then counts
        Cartesian points, whatever is chosen), ``literal`` (the paper's recipe), ``direct`` (O(N^{2d})
        reference), ``fast``, ``radial`` (isotropic densities and constant e only; N_rho, M_sph, M_cir,
        variant are not used),
        ``carleman`` (elastic and near-elastic scenes; N_rho is not used), ``dsmc`` (particles: no operator,
        `granstudy.simulate` only; N and R say the cells and the box that the initial density is drawn on,
        and nothing else but the three fields of particles is used).
    sphere_rule : str
        ``design``, ``lebedev``, ``product``, ``gauss-theta-phi``, or a text file of unit vectors.
    radial_rule : str
        ``legendre`` (the paper) or ``jacobi`` (spectral for every λ).
    rtol : float or None
        For `fast`, and `auto`: tolerance in (0, 1) of Q's quadrature error over max|Q| (near an
        equilibrium, where Q vanishes, over a hundredth of the loss), and half that of its mass, momentum
        and energy over those of |Q|. The shells and the rule of each are then chosen for the scene, and
        N_rho, M_sph, M_cir,
        sphere_rule and radial_rule are left alone.
    circular : bool
        For `direct`: do as the paper's direct method does. l+m wraps around the spectrum, as
        products on the grid do, and sinc is evaluated as in the paper's code.
    particles : int or None
        For `dsmc`, which needs it: particles of all batches together, a multiple of ``batches``.
    batches : int
        For `dsmc`: independent batches, at least 2, whose spread gives the standard errors.
    seed : int
        For `dsmc`: of the random numbers. The same seed gives the same bytes, whatever ``threads``.
    dealias : bool
        For `fast`, and `auto`: form the products on a grid of 3N/2 points a dimension, so that nothing wraps
        around the spectrum; about five times the time at N = 32 in 3D.
    precision : str
        For `fast`, and `auto`: ``double``, or ``single`` for the transforms and loops of the gain's nodes,
        about twice as fast, with a round-off of some 1e-7 of max|Q⁺|.
    threads : int or None
        Threads to use, None for one a core. Results do not depend on it.
    device : str
        ``cpu`` or ``gpu``: where `fast` sums over its nodes. A GPU needs CuPy or PyTorch (``pip install
        'granstudy[gpu]'``) and a restitution that is a constant; results differ by round-off.

    Raises
    ------
    ValueError
        If a field is outside what is stated above; the message names field, value and allowed.
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

    def __post_init__(self) -> None:
        for field, allowed in (
            ("variant", VARIANTS),
            ("method", tuple(METHODS)),
            ("radial_rule", RADIAL_RULES),
            ("precision", PRECISIONS),
            ("device", DEVICES),
        ):
            if getattr(self, field) not in allowed:
                raise unknown_name(field, getattr(self, field), allowed)
        self._check_grid()
        self._check_sizes()
        self._check_only_some()
        if self.rtol is not None:
            self._check_rtol(self.rtol)
        if self.traits.by_particles:
            self._check_particles()

    def _check_grid(self) -> None:
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
        if self.N_rho is not None:
            check_count("N_rho", self.N_rho)
        elif not self.traits.free_radii:
            allowed = next(name for name, method in METHODS.items() if method.free_radii)
            raise ValueError(f"N_rho=None: only method {allowed!r} allows it, not {self.method!r}")
        check_count("M_cir", self.M_cir)
        if not isinstance(self.M_sph, (tuple, list)):
            check_count("M_sph", self.M_sph)
        if self.threads is not None:
            check_count("threads", self.threads)
        if not isinstance(self.dealias, bool):
            raise ValueError(f"dealias={self.dealias!r}: must be True or False")

    def _check_only_some(self) -> None:
        """Raise ValueError for a field that only other methods take."""
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            others = field.name in ONLY_SOME and field.name not in self.traits.takes
            if others and value != field.default:
                raise ValueError(
                    f"{field.name}={value!r}: only {that_take(field.name)} it, not {self.method!r}"
                )

    def _check_rtol(self, rtol: object) -> None:
        if isinstance(rtol, bool) or not isinstance(rtol, (int, float)) or not 0.0 < rtol < 1.0:
            raise ValueError(f"rtol={rtol!r}: must be a number between 0 and 1, or None")
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if field.name in QUADRATURE and value != field.default:
                raise ValueError(
                    f"{field.name}={value!r}: rtol={rtol!r} chooses it; leave one of them out"
                )

    def _check_particles(self) -> None:
        check_count("particles", self.particles)
        check_count("batches", self.batches)
        assert self.particles is not None
        if self.batches < 2:
            raise ValueError(f"batches={self.batches!r}: must be at least 2, for standard errors")
        if self.particles % self.batches or self.particles < LEAST_PARTICLES * self.batches:
            raise ValueError(
                f"particles={self.particles!r}: must be a multiple of batches={self.batches}, at least "
                f"{LEAST_PARTICLES * self.batches}"
            )
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0:
            raise ValueError(f"seed={self.seed!r}: must be an integer of at least 0")

    def __eq__(self, other: object) -> bool:
        """Whether the other one has the same fields, sized or not."""
        return isinstance(other, Solver) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def _values(self) -> tuple[Any, ...]:
        return tuple(getattr(self, field.name) for field in dataclasses.fields(Solver))

    @property
    def traits(self) -> Method:
        """What its method takes."""
        return METHODS[self.method]

    @property
    def is_open(self) -> bool:
        """Whether it leaves the method or the grid to be chosen for a scene."""
        return self.traits.chooses or self.N is None

    def sized(self) -> "SizedSolver":
        """The same solver as one whose N and R are known.

        Raises
        ------
        ValueError
            If N and R are left open.
        """
        if self.N is None:
            raise ValueError("N=None: choose N and R first, with granstudy.choose")
        return SizedSolver(*self._values())

    def grid(self, dim: int) -> VelocityGrid:
        """The Cartesian velocity grid in ``dim`` dimensions, of every method but `radial`."""
        sized = self.sized()
        return VelocityGrid(dim, sized.N, sized.R)

    @property
    def thread_count(self) -> int:
        """Threads to use."""
        return self.threads or len(os.sched_getaffinity(0))

    def coordinates(self, dim: int) -> dict[str, Any]:
        """What is swept of a solver and plays a part, by the names of `granstudy.datasets.parameters`."""
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
        """The tolerance, or the sizes that it takes the place of."""
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

        ``threads`` is left out: it changes how long a run takes, not what comes out. So is what plays no
        part, ``rtol`` or what it chooses, and so
        are the fields of `PRODUCTS` that are not in use.
        """
        every = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        unused = {"threads", *({"rtol"} if self.rtol is None else QUADRATURE)}
        unused |= {name for name in PRODUCTS if every[name] == NOT_IN_USE[name]}
        unused |= self.traits.unused if self.traits.by_particles else PARTICLES
        return {key: value for key, value in every.items() if key not in unused}


NOT_IN_USE = {"dealias": False, "precision": PRECISIONS[0], "device": DEVICES[0]}
"""Values of fields of `PRODUCTS` that a description leaves out."""


@dataclass(frozen=True, eq=False)
class SizedSolver(Solver):
    """A solver whose N and R are known, as every operator needs them; see `Solver`."""

    N: int
    R: float

    def sized(self) -> "SizedSolver":
        """The solver itself."""
        return self

    @property
    def product_points(self) -> int:
        """Points a dimension on which `fast` forms products: N, or 3N/2 and even where they are padded.

        Two spectra of modes up to N/2 have a product with modes up to N; on 3N/2 points those above N wrap
        around to modes of N/2 and more, which are dropped.
        """
        return 2 * math.ceil(3 * self.N / 4) if self.dealias else self.N


@dataclass(frozen=True)
class Choice:
    """What became of a solver that left something open.

    Attributes
    ----------
    asked : Solver
        What was asked for.
    solver : SizedSolver
        What does it: the same where nothing was left open.
    reason : str
        Why, in a line.
    """

    asked: Solver
    solver: SizedSolver
    reason: str

    def attributes(self) -> dict[str, str]:
        """What a dataset says about it, beside the ``solver`` that did it; nothing where nothing was open."""
        if self.solver == self.asked:
            return {}
        asked = json.dumps(self.asked.describe(), sort_keys=True)
        return {"asked_solver": asked, "choice": self.reason}
