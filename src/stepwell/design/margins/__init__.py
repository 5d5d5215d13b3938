"""How far a chain is from doing something else, and the nearest place where it does."""
