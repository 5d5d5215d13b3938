"""Commands about robots."""
