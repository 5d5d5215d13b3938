"""Robots and arenas, drawn from their values."""
