"""Checks at the door: what came, what is allowed, what to do."""

import math
from collections.abc import Sequence
from itertools import pairwise

from stepwell.base.errors import InputError

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


def short(number: float) -> str:
    """A bound as messages write it: 1e-6, 0.01."""
    return f"{number:g}".replace("e-0", "e-").replace("e+", "e")


def vector(name: str, value: Sequence[float]) -> Vec2:
    """`value` as two floats [m]; raises ValueError otherwise."""
    try:
        x, y = value
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r}: must be two numbers (x, y) [m].") from None
    return finite(f"{name}[0]", x, "m"), finite(f"{name}[1]", y, "m")


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
    name: str, values: Sequence[float], unit: str, beside: str, count: int
) -> tuple[float, ...]:
    """`values` as floats, if they are as many as those of `beside`; raises ValueError otherwise."""
    numbers = tuple(finite(f"{name}[{i}]", value, unit) for i, value in enumerate(values))
    if len(numbers) != count:
        raise InputError(f"{name} has {len(numbers)} values, {beside} {count}: must be as many.")
    return numbers


def pulls(name: str, values: Sequence[float], unit: str) -> None:
    """Raise ValueError where a band would push."""
    for i, pull in enumerate(values):
        if pull < 0:
            raise InputError(
                f"{name}[{i}] = {pull} {unit}: must be >= 0, a band pulls. Did you mean {-pull} "
                f"{unit}?"
            )
