"""Long lists of notes and rows on a terminal: one line for each kind, with its count."""

import re
from collections.abc import Sequence

from stepwell.accounts.parts import TERMINAL, Level, Notes, Part
from stepwell.base import counted, grouped

# Letters of a line; the rest of a longer one is on the page and in JSON.
_WIDE = 96
# A word that names one file, run or number, and is not the kind of a note.
_OWN = re.compile(r"^['(+-]*[\w./\\-]*[\d_/\\][\w./\\%-]*[',);]*$")


def folded_notes(
    heading: str, lines: Sequence[str], most: int = 3, level: Level = TERMINAL
) -> dict[str, Part]:
    """Section of a list of notes: one line for each kind on a terminal, all lines on a page.

    Args:
        heading: of the section.
        lines: the notes, each "name: text".
        most: number of kinds that a terminal shows.
        level: shortest form that shows the folded list.
    """
    if not lines:
        return {}
    short = by_kind(lines, most)
    if len(lines) <= most and all(len(line) <= _WIDE for line in lines):
        return {heading: Notes(lines, level)}
    return {heading: Notes(lines, level, short)}


def by_kind(lines: Sequence[str], most: int = 3) -> list[str]:
    """The first line of each kind with the count of its kind, rare kinds first.

    Lines are of one kind if they differ in names of files and numbers only. Of more than `most`
    kinds, the last line has the count of the others.
    """
    kinds = sorted(grouped((_kind(line), line) for line in lines).values(), key=len)
    if len(kinds) > most:
        kinds, rest = kinds[: most - 1], kinds[most - 1 :]
        hidden = sum(map(len, rest))
        return [*map(_first, kinds), counted(hidden, "more note")]
    return [*map(_first, kinds)]


def clipped(text: str, letters: int = _WIDE) -> str:
    """A text in at most this many letters, cut at a space."""
    if len(text) <= letters:
        return text
    return f"{text[: letters - 4].rpartition(' ')[0].rstrip(',;:')} ..."


def _first(lines: Sequence[str]) -> str:
    more = f" (and {len(lines) - 1} of this kind)" if len(lines) > 1 else ""
    source, colon, text = lines[0].partition(": ")
    file = source.replace("\\", "/").rpartition("/")[2]
    return clipped(f"{file}{colon}{text}", _WIDE - len(more)) + more


def _kind(line: str) -> str:
    """The first part of a note that is no name, without its names and numbers."""
    _, *parts = line.split(": ") if ": " in line else ("", line)
    for part in parts:
        words = [word for word in part.split() if not _OWN.match(word)]
        if any(len(word) > 2 for word in words):
            return " ".join(words)
    return line if not parts else parts[-1]
