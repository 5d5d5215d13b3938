"""Shared parts of figures: style, names, labels, marks."""
