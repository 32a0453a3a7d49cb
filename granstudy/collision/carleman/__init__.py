"""Carleman."""
