"""Cooling and heated states, solved for directly."""
