"""Ranges of numbers as commands take them: FROM:TO, FROM:TO:COUNT, either behind NAME=."""

import re
from dataclasses import dataclass

import typer

import stepwell as sw
from stepwell.base import require, short
from stepwell.cli.screen import usable

EXAMPLE = "outer.q.x=0:20:41"
_PARTS = re.compile(r"(?:(.+?)=)?([^:=]+):([^:=]+)(?::(-?\d{1,15}))?(:log)?")


@dataclass(frozen=True)
class Range:
    """`count` numbers from `start` to `stop`, both included, in the unit in which they are written.

    They lie at equal steps or, with `log`, in equal ratios.
    """

    start: float
    stop: float
    count: int | None = None
    name: str = ""
    log: bool = False

    def values(self, factor: float = 1.0) -> "sw.base.Floats":
        """(count,) the numbers, in a unit that is `factor` times the one they are written in."""
        import numpy as np

        space = np.geomspace if self.log else np.linspace
        return space(self.start / factor, self.stop / factor, self.count or 1)

    def __str__(self):
        parts = self.start, self.stop, self.count
        return ":".join(f"{part:g}" for part in parts if part is not None)


def read_range(text: str, form: str, example: str) -> Range:
    """A range that is written as `form` says, such as "FROM:TO in mm"; "COUNT" is 2 or more."""
    parts = _PARTS.fullmatch(text)
    wrong = typer.BadParameter(f"{text!r}: must be {form}, as in {example}.")
    if parts is None:
        raise wrong
    name, start, stop, count, log = parts.groups()
    asked = [(name, "="), (count, ":COUNT")] + [(log, ":log")] * bool(log)
    if any((part is not None) != (sign in form) for part, sign in asked):
        raise wrong
    many = int(count) if count else None
    try:
        found = Range(float(start), float(stop), many, name or "", bool(log))
    except ValueError:
        raise wrong from None
    if found.count is not None and found.count < 2:
        raise typer.BadParameter(f"{text!r}: the count must be 2 or more.")
    return found


def _rising(text: str | Range, form: str, example: str, most: float, unit: str = "") -> Range:
    if isinstance(text, Range):  # the default
        return text
    found = read_range(text, form, example)
    if not -most <= found.start < found.stop <= most:
        bounds = f"-{short(most)} to {short(most)}{unit}"
        raise typer.BadParameter(f"{text!r}: must rise, as {example} does, within {bounds}.")
    with usable():
        require("points", found.count or 0, f"{text!r}:")
    return found


def span(text: str | Range) -> Range:
    """FROM:TO in mm."""
    return _rising(text, "FROM:TO in mm", "0:20", 1e6, " mm")


def grid(text: str | Range) -> Range:
    """FROM:TO:COUNT in mm."""
    return _rising(text, "FROM:TO:COUNT in mm", "0:20:200", 1e6, " mm")


def parameter_range(text: str | Range) -> Range:
    """NAME=FROM:TO:COUNT, with :log at the end for equal ratios instead of equal steps."""
    found = _rising(text, "NAME=FROM:TO:COUNT or NAME=FROM:TO:COUNT:log", EXAMPLE, 1e9)
    if found.log and found.start <= 0:
        raise typer.BadParameter(f"{text!r}: must start above 0 for equal ratios.")
    return found


def window(text: str, *, whole: bool = False) -> tuple[float, float]:
    """FROM:TO of a recording, not negative: `whole` numbers, or any; they may be equal."""
    form, example = ("whole numbers", "5:9") if whole else ("numbers that rise", "5:35")
    form = f"FROM:TO, two {form}"
    found = read_range(text.strip(), form, example)
    exact = not whole or (found.start == int(found.start) and found.stop == int(found.stop))
    if not (0 <= found.start <= found.stop < float("inf") and exact):
        raise typer.BadParameter(f"{text!r}: must be {form}, as in {example}.")
    return found.start, found.stop
