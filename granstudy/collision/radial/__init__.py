"""Radial."""
