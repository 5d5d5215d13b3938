"""Text as people may be shown it, whatever it holds."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


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
