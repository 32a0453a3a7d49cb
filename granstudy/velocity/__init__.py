"""Velocity."""
