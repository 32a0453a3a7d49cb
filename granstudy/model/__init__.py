"""What is configured: the scene (density, kernel, restitution, heating) and the solver."""
