"""Numbers printed in the paper (docs/method.md §6)."""
