"""A study in one's hands: open it, sweep, compute here or on a cluster."""
