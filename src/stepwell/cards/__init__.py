"""Cards: what notebooks show of a value, made from the same schemas as JSON and tables."""

from stepwell.cards.cards import card

__all__ = ["card"]
