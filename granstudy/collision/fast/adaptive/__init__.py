"""The fast operator with a quadrature chosen for a tolerance (`Solver.rtol`)."""
