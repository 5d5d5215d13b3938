"""Stroke programs: the turning points that bring a chain to a state."""
