"""Places for all anchors at once, and how surely they serve."""
