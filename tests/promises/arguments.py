"""Random arguments, densities and laws: taken, or refused by one error that names one of them."""

from math import ceil

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from random_arguments import CALLS

from promises.trial import Trial

OWN_FUNCTIONS = (
    "simulate own functions",
    "simulate own functions by particles",
    "evaluate",
)
"""Calls whose odd arguments are densities and laws."""

ARGUMENTS = tuple(name for name in CALLS if name not in OWN_FUNCTIONS)
"""All other calls."""


def trials(names, count, first=0):
    """So many calls, shared out to those of the given names."""
    for name in names:
        yield from _calls(name, ceil(count / len(names)), first)


def _calls(name, count, first):
    found = []

    @seed(first)
    @settings(
        max_examples=count, deadline=None, database=None, phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(st.data())
    def tried(data):
        words = CALLS[name].drawn(data.draw)
        try:
            said = CALLS[name].verdict(words)
        except Exception as error:
            found.append(Trial(False, f"{name}: {type(error).__name__}: {error}"[:120]))
        else:
            found.append(Trial(True, "refused" if said else "taken"))

    tried()
    return found
