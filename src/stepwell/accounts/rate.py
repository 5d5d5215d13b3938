"""The safe rate of a path, up to which masses leave its order as it is, and its assumptions."""

import math

from stepwell.accounts.head import keys
from stepwell.accounts.parts import Fact
from stepwell.base import Schema, amount
from stepwell.statics import Path, SafeRate


def _finite(path: Path) -> float | None:
    rate = path.usual_safe_rate.rate
    return None if rate is None or math.isinf(rate) else rate


def assumed_of(safe: SafeRate) -> str:
    """What a safe rate assumes, or why there is none."""
    if safe.rate is None or math.isinf(safe.rate):
        return safe.reason
    how = "proved by energy" if safe.proved else "two rates were integrated"
    mass = amount(safe.masses[0], "kg", 3)
    return f"blocks of {mass}, no dampers, dead stops, a crank; snaps: {how}"


# Of a path: cycles per second, None where any rate is safe or none is known to be.
RATE: Schema = keys(
    safe_rate=("Hz", _finite),
    safe_rate_assumes=(str, lambda path: assumed_of(path.usual_safe_rate)),
)


def rate_fact(path: Path) -> Fact:
    """The safe rate in a line."""
    safe = path.usual_safe_rate
    if safe.rate is None:
        text = f"none known: {safe.reason}"
    elif math.isinf(safe.rate):
        text = f"any: {safe.reason}"
    else:
        text = f"{amount(safe.rate, 'Hz', 3)} with blocks of {amount(safe.masses[0], 'kg', 3)}"
    return Fact("Safe rate", text)
