"""The keys of design files with their values and units."""
