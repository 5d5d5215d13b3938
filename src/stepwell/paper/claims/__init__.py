"""A claim, and the table of verdicts."""
