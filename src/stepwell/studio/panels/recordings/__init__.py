"""What the page asks of recordings: how a measurement and the design agree."""
