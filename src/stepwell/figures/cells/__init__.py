"""Unit cells and the mechanism itself, drawn."""
