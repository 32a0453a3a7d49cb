"""What every room stands on: checks, errors, files, the cache on disk, the fingerprint of code."""
