"""Exact and asymptotic laws of the homogeneous granular gas, each with its source."""

from granstudy.theory.cooling import (
    cooling_correction,
    gaussian_cooling_coefficient,
    haff_constant,
    haff_temperature,
    heated_temperature,
)
from granstudy.theory.maxwell import (
    MomentRates,
    maxwell_a2,
    maxwell_anisotropy_rate,
    maxwell_moment_rates,
    maxwell_pressure,
    maxwell_temperature,
    maxwell_third_moments,
)
from granstudy.theory.maxwell_states import (
    maxwell_cooling_moments,
    maxwell_heated_moments,
    maxwell_tail_exponent,
    sonine_coefficients,
)
from granstudy.theory.sonine import (
    a2_relaxation_rate,
    cooling_state_a2,
    heated_state_a2,
    montanero_santos_a2,
)
from granstudy.theory.tails import cooling_tail_rate, heated_tail_rate

__all__ = [
    "MomentRates",
    "a2_relaxation_rate",
    "cooling_correction",
    "cooling_state_a2",
    "cooling_tail_rate",
    "gaussian_cooling_coefficient",
    "haff_constant",
    "haff_temperature",
    "heated_state_a2",
    "heated_tail_rate",
    "heated_temperature",
    "maxwell_a2",
    "maxwell_anisotropy_rate",
    "maxwell_cooling_moments",
    "maxwell_heated_moments",
    "maxwell_moment_rates",
    "maxwell_pressure",
    "maxwell_tail_exponent",
    "maxwell_temperature",
    "maxwell_third_moments",
    "montanero_santos_a2",
    "sonine_coefficients",
]
