"""What a robot's results rest on, as people read it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stepwell.cli.screen import show_lines

_WIDTH = 96


def show_sources(parameters: list[dict[str, Any]]) -> None:
    """Print which numbers are known, and from where, and which are assumed, with their values."""
    known = [one for one in parameters if one["source"] != "assumed"]
    assumed = [one for one in parameters if one["source"] == "assumed"]
    for source in dict.fromkeys(one["source"] for one in known):
        keys = [one["key"] for one in known if one["source"] == source]
        show_lines("", f"From {_named(source)}", *_wrapped(keys))
    if assumed:
        values = [f"{one['key']} = {value_text(one)}" for one in assumed]
        show_lines("", "Assumed, and the results depend on it", *_wrapped(values))


def value_text(parameter: Mapping[str, Any]) -> str:
    """The numbers of a parameter; its key names the unit."""
    return ", ".join(f"{value:.6g}" for value in parameter["values"])


def _named(source: str) -> str:
    return {"measured": "measurements"}.get(source, f"the {source}")


def _wrapped(items: list[str]) -> list[str]:
    """The items one after another, never broken within."""
    lines: list[str] = []
    for i, item in enumerate(items):
        text = item + (";" if i < len(items) - 1 else "")
        if lines and len(lines[-1]) + 1 + len(text) <= _WIDTH:
            lines[-1] += f" {text}"
        else:
            lines.append(f"  {text}")
    return lines
