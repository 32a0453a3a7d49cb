"""An accuracy of the answer in place of a grid: what it takes is chosen, and chosen again on the way."""
