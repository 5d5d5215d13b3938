"""Arenas in a model: the ground and obstacles on it."""
