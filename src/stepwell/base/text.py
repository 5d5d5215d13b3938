"""Text as people may be shown it, whatever it holds; words that come with advice."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import StrEnum
from typing import Self


def printable(text: str) -> str:
    """`text` on one line, with whatever a terminal cannot show, or obeys, escaped."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def nearest_word(word: str, known: Iterable[str]) -> str | None:
    """The known word that was probably meant, if any is near."""
    folded = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower()[:80], folded, n=1)
    return folded[near[0]] if near else None


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
