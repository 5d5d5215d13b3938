"""Text as people may be shown it, whatever it holds."""

from __future__ import annotations


def printable(text: str) -> str:
    """`text` on one line, with whatever a terminal cannot show, or obeys, escaped."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )
