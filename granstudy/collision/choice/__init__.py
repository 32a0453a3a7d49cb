"""Which method computes Q, on which grid, and at what cost."""
