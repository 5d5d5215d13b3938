"""States, sequences, pathways, and the full cycle of a chain."""
