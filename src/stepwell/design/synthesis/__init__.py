"""Inverse design: chains that reach a target, or the proof that there are none."""
