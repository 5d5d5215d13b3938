"""Curves in a plane of two parameters: traced, bisected, made smooth, cut."""
