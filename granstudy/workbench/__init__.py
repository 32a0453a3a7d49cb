"""A study in one's hands: open it, sweep, compute."""
