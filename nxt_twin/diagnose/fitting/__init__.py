"""A case made ready, and plants fitted to its readings: windows, noise, likelihood, free runs."""
