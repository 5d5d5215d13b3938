"""The parameters of a chain by name."""
