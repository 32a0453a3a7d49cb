"""What becomes of what a solver leaves open."""

import json
from dataclasses import dataclass

from granstudy.model.solver import SizedSolver, Solver


@dataclass(frozen=True)
class Choice:
    """A solver as it was asked for, and as it was chosen for a scene (`granstudy.choose`).

    Attributes
    ----------
    asked : Solver
        The solver asked for, which may leave grid or method open.
    solver : SizedSolver
        The solver chosen; the same where nothing was open.
    reason : str
        Why, in a line; "" where nothing was open.
    """

    asked: Solver
    solver: SizedSolver
    reason: str

    def attributes(self) -> dict[str, str]:
        """Attributes of a dataset beside its ``solver``: none where nothing was open."""
        if self.solver == self.asked:
            return {}
        asked = json.dumps(self.asked.describe(), sort_keys=True)
        return {"asked_solver": asked, "choice": self.reason}
