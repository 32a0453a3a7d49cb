"""What a run computes, its key, its cost, and the store that keeps each run once."""
