"""Grids of a run to an accuracy: which one, and how a density changes from one to another."""
