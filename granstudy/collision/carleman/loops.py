"""Compiled loops of the Carleman form: a share of its sum of products."""

from granstudy.collision.fourier.fftw import BACKWARD, execute
from granstudy.support.compiled import compiled


@compiled(forceinline=True)
def filter_modes(f_hat, weights, odd, turn, counts, starts, out):
    """out = weights f̂ on the ball of modes, times i·turn where ``odd``; 0 on all other modes."""
    nx, ny, nz = f_hat.shape
    factor = turn * 1j if odd else 1.0 + 0.0j
    for i in range(nx):
        for j in range(ny):
            count = counts[i, j]
            start = starts[i, j]
            if odd:
                for k in range(count):
                    out[i, j, k] = factor * (weights[start + k] * f_hat[i, j, k])
            else:
                for k in range(count):
                    out[i, j, k] = weights[start + k] * f_hat[i, j, k]
            for k in range(count, nz):
                out[i, j, k] = 0.0


@compiled(fastmath={"contract"}, forceinline=True)
def add_product(first, second, total):
    """Add first·second to ``total`` (n n', n). In-place transforms pad the rows of both factors."""
    rows, n = total.shape
    for j in range(rows):
        for k in range(n):
            total[j, k] += first[j, k] * second[j, k]


@compiled()
def sum_products(
    f_hat, of_l, of_m, odd, counts, starts, a_spectrum, b_spectrum, a, b, a_plans, b_plans, gain
):
    """gain = Σ ab, shape (n n', n): a is transformed from f̂ times a filter of l, b from f̂ times one of m."""
    gain[:] = 0.0
    for i in range(len(odd)):
        filter_modes(f_hat, of_l[i], odd[i], -1, counts, starts, a_spectrum)
        execute(a_plans, BACKWARD)
        filter_modes(f_hat, of_m[i], odd[i], 1, counts, starts, b_spectrum)
        execute(b_plans, BACKWARD)
        add_product(a, b, gain)
