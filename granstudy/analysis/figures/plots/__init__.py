"""Plots of labelled data, by the same functions for study files and for `ds.granular.plot`."""
