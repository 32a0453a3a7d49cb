"""The Carleman form of the collision operator, method `carleman` (docs/method.md §8)."""
