"""Measured data beside their model."""
