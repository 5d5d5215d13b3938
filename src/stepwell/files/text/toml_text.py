"""TOML out: numbers, lists and text as a person would write them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

# The keys of a table, each with its value as it stands in the file.
Written = dict[str, str]


def array(items: Iterable[str]) -> str:
    """A list of what is written already."""
    return f"[{', '.join(items)}]"


def inline(keys: Mapping[str, str]) -> str:
    """A table on one line."""
    return "{ " + ", ".join(lines(keys)) + " }"


def lines(keys: Mapping[str, str]) -> list[str]:
    """A line for each key."""
    return [f"{key} = {value}" for key, value in keys.items()]


def quoted(text: str) -> str:
    """Text in quotes."""
    # JSON's escapes are TOML's, but TOML also wants the delete character escaped.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
