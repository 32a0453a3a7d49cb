"""A density through time: frames, schemes and steps, conservation, and forecasts of runs."""
