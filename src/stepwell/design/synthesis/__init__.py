"""Chains designed for a wish, or the proof or the search that found none."""
