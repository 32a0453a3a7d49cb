"""Which rule every shell gets, so that their errors together stay under a bound at least cost."""

from collections.abc import Sequence

import numpy as np


def allocate(
    errors: Sequence[np.ndarray], costs: Sequence[np.ndarray], bound: float, weights: np.ndarray
) -> list[int]:
    """One choice a shell with max|Σ_i errors_i[choice_i]| ≤ bound.

    Greedy on J = ‖Σ_i e_i‖² + Σ_i ‖e_i‖²: the first term knows that errors of different shells cancel or
    add up, the second keeps the choice from resting on cancellation, which another density would not
    have. Each round takes the step of the largest gain a unit of cost; once under the bound, shells
    fall back to cheaper choices as long as the bound holds.

    Parameters
    ----------
    errors : sequence of ndarray, shape (choices, points)
        For every shell the error of each choice, cheapest first; the last one is about 0.
    costs : sequence of ndarray, shape (choices,)
    weights : ndarray, shape (points,)
        Of the squares in the norm.
    """
    chosen = [0] * len(errors)
    total = np.sum([e[0] for e in errors], axis=0)
    squares = [e**2 @ weights for e in errors]
    while np.max(np.abs(total)) > bound:
        step = _best_step(errors, squares, costs, chosen, total, weights)
        if step is None:  # nothing left that helps: all that there is
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
    """The shell and the dearer choice by which J falls most a unit of cost."""
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
