"""A study on one page: tables, figures, labels, what failed and why, times, where all came from."""
