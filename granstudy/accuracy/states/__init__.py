"""Cooling and heated states to an accuracy."""
