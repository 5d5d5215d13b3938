"""Simulation of hoppers: model, run, jumps, videos."""
