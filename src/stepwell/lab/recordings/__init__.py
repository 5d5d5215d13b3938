"""Recordings of test machines: reading, names, warnings, mean curves."""
