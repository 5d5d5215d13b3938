"""Transition graphs, drawn."""
