"""A density through time: frames, schemes, steps, conservation, forecasts."""
