"""The tables of a design file as values, and back."""
