"""Claims of others."""
