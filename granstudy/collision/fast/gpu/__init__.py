"""The fast operator with its sum over nodes on a GPU (`Solver.device`)."""
