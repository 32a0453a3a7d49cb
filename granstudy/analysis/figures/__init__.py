"""Figures of an experiment's table and runs, a file a kind, and the map of a study."""
