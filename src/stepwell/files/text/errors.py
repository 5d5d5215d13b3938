"""What is wrong with a design file, in one line for each problem."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from decimal import Decimal
from typing import Any

from stepwell.base import InputError, nearest_word, printable

MOST_LINES = 40


class DesignError(InputError):
    """A design file that cannot be used; `str` of it is what to show the user.

    Args:
        name: the file, as the user called it.
        problems: one line each: where, what came, what is allowed, what was probably meant.
        more: problems there are besides.
    """

    def __init__(self, name: str, problems: Iterable[str], more: int = 0):
        self.name = printable(name)
        self.problems = tuple(problems)
        lines = [f"{self.name}: {problem}" for problem in self.problems[:MOST_LINES]]
        if (unlisted := len(self.problems) + more - len(lines)) > 0:
            lines.append(f"{self.name}: and {unlisted} more like these.")
        super().__init__("\n".join(lines))


def key_path(keys: Sequence[str | int]) -> str:
    """("chain", "cell", 1, "q_mm") as chain.cell[1].q_mm."""
    path = ""
    for key in keys:
        if isinstance(key, int):
            path += f"[{key}]"
            continue
        bare = key.isascii() and key.replace("_", "").replace("-", "").isalnum()
        shown = key if bare else json.dumps(key, ensure_ascii=False)
        path += ("." if path else "") + _cut(printable(shown))
    return path


def value_text(value: Any) -> str:
    """A value as the file would write it, on one short line."""
    if isinstance(value, dict):
        names = [key_path([str(key)]) for key in list(value)[:4]]
        return _cut("{" + ", ".join(names + ["..."] * (len(value) > 4)) + "}")
    if isinstance(value, list | tuple):
        items = [value_text(item) for item in value[:4]]
        return _cut("[" + ", ".join(items + ["..."] * (len(value) > 4)) + "]")
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int) and abs(value) >= 10**15:
        return f"an integer of {value.bit_length()} bits"
    if isinstance(value, Decimal):
        if value.is_nan():
            return "nan"
        return "-inf" * value.is_signed() or "inf" if value.is_infinite() else _cut(str(value))
    if isinstance(value, str):
        return _cut(printable(json.dumps(value[:80], ensure_ascii=False)))
    return _cut(printable(str(value)))


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A sentence that names the nearest known word, or all of them where none is near."""
    known = list(known)
    near = nearest_word(word, known)
    return f"Did you mean {near}?" if near else f"Known here: {', '.join(known)}."


def _cut(text: str, most: int = 60) -> str:
    return text if len(text) <= most else text[: most - 3] + "..."
