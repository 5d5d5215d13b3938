"""Checks of numbers, default tolerances, and bisection."""

import math
from collections.abc import Callable, Iterable, Sequence
from enum import StrEnum
from itertools import pairwise
from typing import Any

from stepwell.base.errors import InputError

# Default tolerances of a careful workshop with a bag of rubber bands: radius around every anchor
# [m], and standard deviation of a band's stiffness over its mean [1].
USUAL_ANCHOR = 0.0003
USUAL_STIFFNESS = 0.05
# Largest displacement of an anchor in a search for changes [m].
REACH = 0.020
# Samples of a yield: decided by the critical forces, or followed one by one by the engine.
QUICKLY, ONE_BY_ONE = 100_000, 500


Vec2 = tuple[float, float]


def finite(name: str, value: float, unit: str) -> float:
    """`value` as a float; raises ValueError unless it is a finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r}: must be a number [{unit}].") from None
    if not math.isfinite(number):
        raise InputError(f"{name} = {number}: must be finite [{unit}].")
    return number


def positive(name: str, value: float, unit: str) -> float:
    """`value` as a float; raises ValueError unless it is finite and above zero."""
    number = finite(name, value, unit)
    if number <= 0:
        raise InputError(f"{name} = {number} {unit}: must be > 0.")
    return number


def not_negative(name: str, value: float, unit: str) -> float:
    """`value` as a float; raises ValueError unless it is finite and at least zero."""
    number = finite(name, value, unit)
    if number < 0:
        raise InputError(f"{name} = {number} {unit}: must be >= 0.")
    return number


def whole(name: str, value: float, least: int) -> int:
    """`value` as an int; raises ValueError unless it is a whole number and at least `least`."""
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError):
        number = None
    if number is None or number != value or number < least:
        raise InputError(f"{name} = {value!r}: must be a whole number >= {least}.")
    return number


def short(number: float) -> str:
    """A bound as text for messages: 1e-6, 0.01."""
    return f"{number:g}".replace("e-0", "e-").replace("e+", "e")


def vector(name: str, value: Sequence[float], unit: str = "m") -> Vec2:
    """`value` as two floats; raises ValueError otherwise."""
    try:
        x, y = value
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r}: must be two numbers (x, y) [{unit}].") from None
    return finite(f"{name}[0]", x, unit), finite(f"{name}[1]", y, unit)


def one_of(name: str, value: object, kind: type[StrEnum]) -> StrEnum:
    """`value` as a member of an enum; raises ValueError, which lists all members, otherwise."""
    try:
        return kind(value)
    except ValueError:
        allowed = ", ".join(repr(str(member)) for member in kind)
        raise InputError(f"{name} = {value!r}: must be one of {allowed}.") from None


def fields(value: object, check: Callable[[str, Any, Any], Any], **units: Any) -> None:
    """Replace fields of a frozen value by the results of a check, each called with its unit."""
    for name, unit in units.items():
        object.__setattr__(value, name, check(name, getattr(value, name), unit))


def rising(name: str, values: Sequence[float], unit: str, least: int) -> tuple[float, ...]:
    """`values` as strictly rising floats, at least `least` of them; raises ValueError."""
    numbers = tuple(finite(f"{name}[{i}]", value, unit) for i, value in enumerate(values))
    if len(numbers) < least:
        raise InputError(f"{name} has {len(numbers)} values: must have {least} or more [{unit}].")
    for i, (low, high) in enumerate(pairwise(numbers)):
        if high <= low:
            raise InputError(
                f"{name}[{i + 1}] = {high} {unit} after {low}: values must rise; sort the table "
                f"and drop repeated rows."
            )
    return numbers


def as_many(
    name: str, values: Iterable[float], unit: str, beside: str, count: int
) -> tuple[float, ...]:
    """`values` as floats, if their number is that of `beside`; raises ValueError otherwise."""
    numbers = tuple(finite(f"{name}[{i}]", value, unit) for i, value in enumerate(values))
    if len(numbers) != count:
        raise InputError(f"{name} has {len(numbers)} values, {beside} {count}: must be equal.")
    return numbers


def pulls(name: str, values: Sequence[float], unit: str) -> None:
    """Raise ValueError if a force of a band is negative, a push."""
    for i, pull in enumerate(values):
        if pull < 0:
            raise InputError(
                f"{name}[{i}] = {pull} {unit}: must be >= 0, a band pulls. Did you mean {-pull} "
                f"{unit}?"
            )


def bisected(
    holds: Callable[[float], bool], good: float, bad: float, halvings: int
) -> tuple[float, float]:
    """Bracket of a change by bisection: the last value at which it `holds`, the first without.

    It holds at `good` and not at `bad`, which may be larger or smaller. Of several changes one is
    bracketed.
    """
    for _ in range(halvings):
        middle = (good + bad) / 2
        if holds(middle):
            good = middle
        else:
            bad = middle
    return good, bad
