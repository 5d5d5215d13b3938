"""Cells and pairs on the test machine beside their model."""
