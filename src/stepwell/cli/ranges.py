"""Lengths and ranges in options: 5mm; FROM:TO or FROM:TO:COUNT, either after NAME=."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import typer

import stepwell as sw
from stepwell.base import require, short
from stepwell.cli.screen import usable

EXAMPLE = "outer.q.x=0:20:41"
_PARTS = re.compile(r"(?:(.+?)=)?([^:=]+):([^:=]+)(?::(-?\d{1,15}))?(:log)?")
_MM = {"mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1e3}


def millimetres(text: str) -> float:
    """A length [mm], written as a number of mm or with its unit: 5, 5mm, 0.5cm, 0.2in."""
    unit = next(filter(text.strip().endswith, _MM), "")
    return float(text.strip().removesuffix(unit)) * _MM.get(unit, 1.0)


def length(least: float = 0.0, most: float = math.inf) -> Callable[[str | float], float]:
    """A parser of an option: a length between two bounds [mm]."""

    def parse(text: str | float) -> float:
        if not isinstance(text, str):  # the default
            return text
        try:
            value = millimetres(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            end = f" to {short(most)}" if most < math.inf else ""
            bounds = f"{short(least)}{end} mm" if end else f"at least {short(least)} mm"
            must = f"must be a length of {bounds}, such as 5mm or 0.2in; without a unit, in mm."
            raise typer.BadParameter(f"{text!r}: {must}")
        return value

    return parse


def percent(most: float) -> Callable[[str | float], float]:
    """A parser of an option: a percentage from 0 to a bound, with or without its sign."""

    def parse(text: str | float) -> float:
        try:
            value = float(str(text).strip().removesuffix("%"))
        except ValueError:
            value = math.nan
        if not 0 <= value <= most:
            raise typer.BadParameter(f"{text!r}: must be 0 to {short(most)} %, such as 5 or 5%.")
        return value

    return parse


def number(text: str | float) -> float:
    """A parser of an option: a finite number of at least 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value < math.inf:
        raise typer.BadParameter(f"{text!r}: must be a number of at least 0.")
    return value


def by_cell(parse: Callable[[str | float], float]) -> Callable[[str | float], Any]:
    """A parser of an option: one value, or one per cell with commas between them, as a tuple."""

    def parse_all(text: str | float) -> Any:
        if not isinstance(text, str) or "," not in text:
            return parse(text)
        return tuple(parse(one) for one in text.split(","))

    return parse_all


@dataclass(frozen=True)
class Range:
    """`count` numbers from `start` to `stop`, both included; lengths in mm.

    Steps are equal or, with `log`, ratios are equal.
    """

    start: float
    stop: float
    count: int | None = None
    name: str = ""
    log: bool = False

    def values(self, factor: float = 1.0) -> "sw.base.Floats":
        """The numbers, divided by `factor`: (count,)."""
        import numpy as np

        space = np.geomspace if self.log else np.linspace
        return space(self.start / factor, self.stop / factor, self.count or 1)

    def __str__(self):
        parts = self.start, self.stop, self.count
        return ":".join(f"{part:g}" for part in parts if part is not None)


def read_range(text: str, form: str, example: str, number: Callable[[str], float] = float) -> Range:
    """A range in the given form, such as "FROM:TO in mm"; "COUNT" is 2 or more."""
    parts = _PARTS.fullmatch(text)
    wrong = typer.BadParameter(f"{text!r}: must be {form}, as in {example}.")
    if parts is None:
        raise wrong
    name, start, stop, count, log = parts.groups()
    asked = [(name, "="), (count, ":COUNT")] + [(log, ":log")] * bool(log)
    if any((part is not None) != (sign in form) for part, sign in asked):
        raise wrong
    points = int(count) if count else None
    try:
        ends = Range(number(start), number(stop), points, name or "", bool(log))
    except ValueError:
        if "=" in form and number is float:
            wrong.message += " Write numbers without a unit; lengths are in mm."
        raise wrong from None
    if points is not None and points < 2:
        raise typer.BadParameter(f"{text!r}: the count must be 2 or more.")
    return ends


def _rising(text: str | Range, form: str, example: str, most: float, unit: str = "") -> Range:
    if isinstance(text, Range):  # the default
        return text
    ends = read_range(text, form, example, millimetres if unit else float)
    if not -most <= ends.start < ends.stop <= most:
        bounds = f"-{short(most)} to {short(most)}{unit}"
        raise typer.BadParameter(f"{text!r}: must rise, as {example} does, within {bounds}.")
    with usable():
        require("points", ends.count or 0, f"{text!r}:")
    return ends


class Point(NamedTuple):
    """A point of a plane [mm]."""

    x: float
    y: float


def point(text: str) -> Point:
    """X:Y, each in mm or with its unit."""
    ends = read_range(text.strip(), "X:Y in mm", "-10:0 or -1cm:0", millimetres)
    if not math.hypot(ends.start, ends.stop) < math.inf:
        raise typer.BadParameter(f"{text!r}: must be finite, as in -10:0.")
    return Point(ends.start, ends.stop)


def span(text: str | Range) -> Range:
    """FROM:TO in mm."""
    return _rising(text, "FROM:TO in mm", "0:20", 1e6, " mm")


def grid(text: str | Range) -> Range:
    """FROM:TO:COUNT in mm."""
    return _rising(text, "FROM:TO:COUNT in mm", "0:20:200", 1e6, " mm")


def parameter_range(text: str | Range) -> Range:
    """NAME=FROM:TO:COUNT, with :log at the end for equal ratios instead of equal steps."""
    ends = _rising(text, "NAME=FROM:TO:COUNT or NAME=FROM:TO:COUNT:log", EXAMPLE, 1e9)
    if ends.log and ends.start <= 0:
        raise typer.BadParameter(f"{text!r}: must start above 0 for equal ratios.")
    return ends


def window(text: str, *, whole: bool = False) -> tuple[float, float]:
    """FROM:TO of a recording, not negative, maybe equal: lengths [mm], or `whole` numbers."""
    form, example = ("whole numbers", "5:9") if whole else ("numbers that rise", "5:35")
    form = f"FROM:TO, two {form}"
    ends = read_range(text.strip(), form, example, float if whole else millimetres)
    if not 0 <= ends.start <= ends.stop < math.inf or (
        whole and not (ends.start.is_integer() and ends.stop.is_integer())
    ):
        raise typer.BadParameter(f"{text!r}: must be {form}, as in {example}.")
    return ends.start, ends.stop
