"""An accuracy of the answer in place of a grid, which is chosen on the way."""
