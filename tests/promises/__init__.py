"""Attacks on what granstudy promises: many random trials each, and what became of them.

``python -m promises`` in the folder ``tests`` makes all trials and writes docs/results/checks/promises.csv;
test_promises.py makes a few of each.
"""
