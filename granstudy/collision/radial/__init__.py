"""The collision operator of isotropic densities, method `radial` (docs/method.md §7)."""
