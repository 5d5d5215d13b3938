"""Atlases as maps on which one walks from machine to machine."""
