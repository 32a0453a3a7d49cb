"""What one reads off runs: densities anywhere, their moments, cooling laws, distances from theory."""
