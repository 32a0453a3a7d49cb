"""A run's last density along the first axis through its bulk velocity, in thermal units."""

import numpy as np
import xarray as xr

from granstudy.evolution.frames.physical import physical_density


def thermal_profile(ds: xr.Dataset) -> tuple[np.ndarray, np.ndarray] | None:
    """Increasing x = (v_x − u_x)/√T, and T^{d/2} f/ρ there; None where no density is kept of the last time.

    Between the nodes of the other axes a Cartesian density is its trigonometric interpolant; a radial one is
    shown at x and −x.
    """
    if "snapshot" not in ds.dims or ds["snapshot"][-1] != ds["time"][-1]:
        return None
    last = ds.isel(time=-1)
    u, d = last["velocity"].values, ds.sizes["component"]
    thermal = np.sqrt(float(last["temperature"]))
    f = physical_density(ds).isel(snapshot=-1)
    values = f.values * thermal**d / float(last["density"])
    if f.ndim == 1:
        r = f["r"].values / thermal
        return np.concatenate([-r[::-1], r]), np.concatenate([values[::-1], values])
    axes = [f[f"v{axis}"].values for axis in ds["component"].values]
    for axis in reversed(range(1, d)):
        values = values @ interpolation(axes[axis], u[axis])
    return (axes[0] - u[0]) / thermal, values


def interpolation(nodes: np.ndarray, x: float) -> np.ndarray:
    """Weights of equidistant nodes for the value at x of their periodic trigonometric interpolant.

    w_j = (1/N) Σ_{|k| ≤ N/2} cos(2πk(x − v_j)/P), P the period; the two unpaired modes count half each.
    """
    N = len(nodes)
    phase = 2.0 * np.pi * (x - nodes) / (N * (nodes[1] - nodes[0]))
    k = np.arange(1, N // 2)
    paired = 2.0 * np.cos(np.multiply.outer(phase, k)).sum(axis=1)
    return (1.0 + paired + np.cos(N // 2 * phase)) / N
