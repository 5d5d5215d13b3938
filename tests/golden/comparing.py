"""Two outputs compared: words exactly, numbers as closely as they can be known.

Numbers without a point are counts, states and names, and must be the same. Others may be off by a
part of themselves; in text, where they were rounded for people, by one in the last digit too.
"""

import difflib
import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

_NUMBER = re.compile(
    r"(?P<room>\ *)(?<![\w.])(?P<number>[-+−±]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)(?![\w.]*\d)"
)


@dataclass(frozen=True)
class Tolerance:
    """How far numbers may be off: a part of themselves, and the smallest that counts."""

    relative: float
    absolute: float

    @property
    def digits(self) -> int:
        """How many digits are worth keeping: two more than are compared."""
        return 2 - round(math.log10(self.relative))


# Of statics: another BLAS library, or another order of a sum, changes the last digits.
EXACT = Tolerance(1e-9, 1e-11)
# Of fits by least squares, which stop where a step gains less than about this.
FITTED = Tolerance(1e-6, 1e-8)
# Of MuJoCo: every contact enlarges what rounding began. Where the state at the start of each piece
# of a walk is off by 1e-15 of itself, work and distance are off by up to 1e-5 of themselves, and
# the turn of a robot that walks straight on by up to 3e-5 degrees.
SIMULATED = Tolerance(1e-4, 1e-4)


def differences(frozen: Any, found: Any, tolerance: Tolerance, at: str = "") -> Iterator[str]:
    """Each place where two results in JSON differ by more than numbers may: what was, what is."""
    if isinstance(frozen, dict) and isinstance(found, dict):
        for name in frozen | found:
            place = f"{at}.{name}" if at else name
            if name not in found:
                yield f"{place}: is missing, was {_short(frozen[name])}"
            elif name not in frozen:
                yield f"{place}: is new, {_short(found[name])}"
            else:
                yield from differences(frozen[name], found[name], tolerance, place)
    elif isinstance(frozen, list) and isinstance(found, list) and len(frozen) == len(found):
        for k, (one, other) in enumerate(zip(frozen, found, strict=True)):
            yield from differences(one, other, tolerance, f"{at}[{k}]")
    elif not _same(frozen, found, tolerance):
        yield f"{at}: {_short(frozen)} -> {_short(found)}"


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 300 else f"{text[:300]}…"


def _same(one: Any, other: Any, tolerance: Tolerance) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        size = max(abs(one), abs(other))
        return abs(one - other) <= max(tolerance.absolute, tolerance.relative * size)
    if isinstance(one, str) and isinstance(other, str):
        return alike(one, other, tolerance)
    # A count is no measurement, and 1 is not true.
    return type(one) is type(other) and one == other


def text_differences(frozen: str, found: str, tolerance: Tolerance) -> list[str]:
    """A unified diff of the lines that differ by more than numbers may; empty where none does."""
    if frozen == found:
        return []
    before, after = frozen.split("\n"), found.split("\n")
    # Lines that are alike are made the same, so that the diff shows only the others.
    matcher = difflib.SequenceMatcher(None, before, after, autojunk=False)
    for kind, a, b, c, d in matcher.get_opcodes():
        if kind == "replace":
            for k in range(min(b - a, d - c)):
                if alike(before[a + k], after[c + k], tolerance):
                    after[c + k] = before[a + k]
    return list(difflib.unified_diff(before, after, "frozen", "found", lineterm="", n=2))


def alike(frozen: str, found: str, tolerance: Tolerance) -> bool:
    """Whether two texts say the same, but for what numbers and their last digit may be off."""
    if frozen == found:
        return True
    if _NUMBER.sub("#", frozen) != _NUMBER.sub("#", found):
        return False
    pairs = zip(_NUMBER.finditer(frozen), _NUMBER.finditer(found), strict=True)
    return all(_close(one, other, tolerance) for one, other in pairs)


def _close(one: re.Match[str], other: re.Match[str], tolerance: Tolerance) -> bool:
    a, b = one["number"], other["number"]
    # A column keeps its width, or else the space before the number.
    if one["room"] != other["room"] and len(one[0]) != len(other[0]):
        return False
    if a == b:
        return True
    if not (_has_point(a) or _has_point(b)):
        return False
    x, y = _value(a), _value(b)
    size = max(abs(x), abs(y))
    last = min(_last(a), _last(b)) * 1.000001
    return abs(x - y) <= max(tolerance.absolute, tolerance.relative * size, last)


def _has_point(number: str) -> bool:
    return "." in number or "e" in number.lower()


def _value(text: str) -> float:
    return float(text.replace("−", "-").lstrip("±"))


def _last(text: str) -> float:
    """One in the last digit of a number as it is written."""
    digits, _, exponent = text.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
