"""What a chain shall do, as states, full cycles and orders of end forces."""
