"""The demonstration in seven steps, and its animated HTML page."""
