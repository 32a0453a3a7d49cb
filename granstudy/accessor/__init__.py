"""`ds.granular`: what one reads off a dataset, and draws of it, in one line each."""
