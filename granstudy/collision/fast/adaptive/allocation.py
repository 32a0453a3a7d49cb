"""Rules for the shells, chosen so that the sum of their errors stays under a bound at least cost."""

from collections.abc import Sequence

import numpy as np


def allocate(
    errors: Sequence[np.ndarray], costs: Sequence[np.ndarray], bound: float, weights: np.ndarray
) -> list[int]:
    """One choice for each shell, such that max|Σ_i errors_i[choice_i]| ≤ bound.

    Greedy on J = ‖Σ_i e_i‖² + Σ_i ‖e_i‖². The first term knows that errors of different shells cancel or
    add up. The second keeps the choice from resting on cancellation, which another density would not have.
    Each round takes the step by which J falls most for a unit of cost. Once the sum is under the bound,
    shells fall back to cheaper choices as long as the bound holds.

    Parameters
    ----------
    errors : sequence of ndarray, shape (choices, points)
        The error of each choice, cheapest first, for every shell. The last error is about 0.
    costs : sequence of ndarray, shape (choices,)
        The cost of each choice, for every shell.
    weights : ndarray, shape (points,)
        Weights of the squares in the norm.
    """
    chosen = [0] * len(errors)
    total = np.sum([e[0] for e in errors], axis=0)
    squares = [e**2 @ weights for e in errors]
    while np.max(np.abs(total)) > bound:
        step = _best_step(errors, squares, costs, chosen, total, weights)
        if step is None:  # no choice helps any more: take the dearest everywhere
            return [len(cost) - 1 for cost in costs]
        shell, choice = step
        total = total + errors[shell][choice] - errors[shell][chosen[shell]]
        chosen[shell] = choice
    while True:
        savings = []
        for shell, now in enumerate(chosen):
            for choice in range(now):
                new = total + errors[shell][choice] - errors[shell][now]
                if np.max(np.abs(new)) <= bound:
                    savings.append((costs[shell][now] - costs[shell][choice], shell, choice))
        if not savings:
            return chosen
        _, shell, choice = max(savings)
        total = total + errors[shell][choice] - errors[shell][chosen[shell]]
        chosen[shell] = choice


def _best_step(
    errors: Sequence[np.ndarray],
    squares: Sequence[np.ndarray],
    costs: Sequence[np.ndarray],
    chosen: Sequence[int],
    total: np.ndarray,
    weights: np.ndarray,
) -> tuple[int, int] | None:
    """The shell, and its dearer choice, by which J falls most for a unit of cost."""
    best, best_gain = None, 0.0
    for shell, now in enumerate(chosen):
        more = np.arange(now + 1, len(costs[shell]))
        if len(more) == 0:
            continue
        change = errors[shell][more] - errors[shell][now]
        fall = -(
            2 * change @ (weights * total)
            + change**2 @ weights
            + squares[shell][more]
            - squares[shell][now]
        )
        gain = fall / (costs[shell][more] - costs[shell][now])
        if gain.max() > best_gain:
            best, best_gain = (shell, int(more[np.argmax(gain)])), gain.max()
    return best
