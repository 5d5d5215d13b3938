"""What the page asks of designs as wholes: which there are, their texts, what can be taken away."""
