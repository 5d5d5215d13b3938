"""Long texts made to fit: broken into lines, sequences told by what moves."""

from __future__ import annotations

import re
from itertools import pairwise


def wrapped(text: str, most: int) -> list[str]:
    """Lines of at most so many characters, broken after a blank, a > or a comma."""
    lines = [""]
    for word in re.split(r"(?<=[ >,])", text):
        if lines[-1] and len(lines[-1]) + len(word.rstrip()) > most:
            lines.append("")
        lines[-1] += word
    return [line.rstrip() for line in lines]


def shortened(text: str, most: int, lines: int = 1) -> str:
    """The text in at most so many lines of so many characters, the rest left out."""
    found = [line if len(line) <= most else line[: most - 1] + "…" for line in wrapped(text, most)]
    if len(found) > lines:
        found[lines - 1] = found[lines - 1][: most - 1].rstrip(" …") + "…"
    return "\n".join(found[:lines])


def sequence_words(text: str, most: int) -> str:
    """A sequence of states; where that is too long, which cells load and unload, by number.

    Args:
        text: such as "00>10>11>01>00"; any other text stays as it is.
        most: characters that there is room for.
    """
    if len(text) <= most or not re.fullmatch(r"\d+(>\d+)+", text):
        return text
    moves: list[tuple[str, str]] = []
    for a, b in pairwise(text.split(">")):
        cells = [k for k, (x, y) in enumerate(zip(a, b, strict=True), 1) if x != y]
        way = "loads" if sum(map(int, b)) > sum(map(int, a)) else "unloads"
        moves.append((way, "+".join(map(str, cells))))
    words = ""
    for (before, _), (way, cells) in pairwise([("", ""), *moves]):
        words += f" {cells}" if way == before else f", {way} {cells}"
    return words.removeprefix(", ")


def minus(text: str) -> str:
    """Numbers with a minus sign in place of every hyphen."""
    return text.replace("-", "\N{MINUS SIGN}")
