"""Results as plain numbers with the unit in every name."""
