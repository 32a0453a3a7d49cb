"""Comparisons and densities that test files share; test_comparison.py makes each one fail."""

import numpy as np

import granstudy as gs


def relative_error(Q, reference):
    """max|Q − reference| / max|reference|."""
    assert np.shape(Q) == np.shape(reference)
    return float(np.max(np.abs(Q - reference)) / np.max(np.abs(reference)))


def assert_near(Q, reference, tolerance, what="relative error"):
    error = relative_error(Q, reference)
    assert error <= tolerance, f"{what} {error:.3g} is above {tolerance:.3g}"


def assert_order(steps, errors, order, cap):
    """The rate exceeds order − 0.25 from each step to the next, and the last error is small."""
    rates = np.diff(np.log(errors)) / np.diff(np.log(steps))
    shown = f"rates {np.round(rates, 2)}, errors {errors}"
    assert np.all(rates > order - 0.25), shown
    assert errors[-1] < cap, shown


def assert_spectral(sizes, errors, rate, floor):
    """Errors fall like e^{−rate·size} until they reach ``floor``, and stay there."""
    sizes, errors = np.asarray(sizes), np.asarray(errors)
    shown = f"floor {floor:.2g}, errors {dict(zip(sizes.tolist(), errors.tolist(), strict=True))}"
    assert errors[-1] <= floor, shown
    # the fit takes the errors above the floor and the first below it
    above = np.flatnonzero(errors > floor)
    assert len(above) >= 2, f"too few errors above the floor: {shown}"
    fit = slice(0, above[-1] + 2)
    slope = -np.polyfit(sizes[fit], np.log(errors[fit]), 1)[0]
    assert slope > rate, f"rate {slope:.2f} is not above {rate}: {shown}"


def assert_printed(value, printed, relative, absolute=0.0):
    """A number agrees with the one printed in the paper."""
    allowed = relative * abs(printed) + absolute
    difference = abs(value - printed)
    assert difference <= allowed, f"{value!r}: printed {printed!r}, off by {difference:.2g}"


class Gaussians:
    """A random sum of three anisotropic Gaussians: no symmetry, unit density."""

    def __init__(self, dim, seed, widths, spread):
        rng = np.random.default_rng(seed)
        self.dim = dim
        self.shares = rng.dirichlet(np.full(3, 4.0))
        self.centres = rng.uniform(-spread, spread, (3, dim))
        axes = np.linalg.qr(rng.normal(size=(3, dim, dim)))[0]
        variances = rng.uniform(*widths, (3, dim)) ** 2
        self.precisions = np.einsum("nij,nj,nkj->nik", axes, 1 / variances, axes)

    def __call__(self, *v):
        v = np.stack(np.broadcast_arrays(*v), axis=-1)
        total = np.zeros(v.shape[:-1])
        for share, centre, precision in zip(
            self.shares, self.centres, self.precisions, strict=True
        ):
            exponent = -0.5 * np.einsum("...i,ij,...j", v - centre, precision, v - centre)
            norm = np.sqrt(np.linalg.det(precision) / (2 * np.pi) ** self.dim)
            total += share * norm * np.exp(exponent)
        return total


BOXES = {2: {"N": 32, "R": 5.0}, 3: {"N": 16, "R": 4.5}}
"""Small grids on which `asymmetric_scene` is resolved to the aliasing floor."""


def asymmetric_scene(dim, seed=0, exponent=0.0, restitution=0.4):
    """A scene with a density of `Gaussians` that `BOXES` resolve."""
    strength = gs.maxwell(dim).strength
    return gs.Scene(
        dim=dim,
        initial=Gaussians(dim, seed, *(((0.6, 0.9), 0.6) if dim == 2 else ((0.8, 1.0), 1.2))),
        kernel=gs.VHS(exponent=exponent, strength=strength),
        restitution=restitution,
    )


def evaluate(scene, f=None, **solver):
    """Q(f,f), by default on the scene's initial density."""
    operator = gs.collision_operator(scene, gs.Solver(**solver))
    return operator(scene.density(operator.grid) if f is None else f)
