"""Tension tests of bands, force laws, and calibrated bands."""
