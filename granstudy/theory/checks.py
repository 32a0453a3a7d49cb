"""Checks of the arguments that several laws take."""

import numpy as np


def check_restitution(restitution: float | np.ndarray) -> None:
    """Raise ValueError unless ``restitution`` is a number in [0, 1], or an array of numbers in [0, 1]."""
    if callable(restitution) or not _within_unit_interval(restitution):
        raise ValueError(f"restitution={restitution!r}: must be a number between 0 and 1")


def check_exponent(exponent: float) -> None:
    """Raise ValueError unless ``exponent`` is a λ in [0, 1], from Maxwell molecules to hard spheres."""
    if not _within_unit_interval(exponent):
        raise ValueError(f"exponent={exponent!r}: must lie between 0 and 1")


def check_tensor(name: str, tensor: np.ndarray, order: int) -> np.ndarray:
    """``tensor`` as an array. Raise ValueError unless it is a tensor of the order in 2D or 3D."""
    array = np.asarray(tensor, dtype=float)
    if array.shape not in {(2,) * order, (3,) * order}:
        raise ValueError(
            f"{name} has shape {array.shape}: must be {(2,) * order} or {(3,) * order}"
        )
    return array


def _within_unit_interval(value: float | np.ndarray) -> bool:
    x = np.asarray(value, dtype=float)
    return bool(np.all((x >= 0.0) & (x <= 1.0)))
