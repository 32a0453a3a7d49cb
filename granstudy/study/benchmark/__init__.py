"""Evaluations of Q timed in turn: error, seconds, memory, and the front of speed against error."""
