"""Tension tests of bands, the laws they follow, and the bands they become."""
