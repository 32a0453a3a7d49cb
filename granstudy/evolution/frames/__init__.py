"""The equation for a density in each frame: on fixed velocities, and on velocities rescaled with the gas."""
