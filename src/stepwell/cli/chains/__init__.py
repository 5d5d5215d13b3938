"""Commands about chains."""
