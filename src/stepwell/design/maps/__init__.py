"""What a chain does for all values of two parameters, and the curves between."""
