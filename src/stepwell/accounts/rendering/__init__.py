"""The forms of an account: JSON Schema, terminal, card, page."""
