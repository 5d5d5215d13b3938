"""The words that results hold, each with what it means and what to do."""

from enum import StrEnum
from typing import Self


class Advised(StrEnum):
    """A word, as JSON and comparisons have it, and a text that says more.

    Attributes:
        advice: what the word means, and what to do about it.
    """

    advice: str

    def __new__(cls, word: str, advice: str) -> Self:
        """Of a word and its advice."""
        member = str.__new__(cls, word)
        member._value_, member.advice = word, advice
        return member

    def __repr__(self):
        return f"{type(self).__name__}.{self.name}"
