"""Checks, errors, whole files, a cache on disk and the fingerprint of code, for all other packages."""
