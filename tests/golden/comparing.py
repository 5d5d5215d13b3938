"""Two told outputs compared: words exactly, numbers as closely as they can be known.

Numbers without a point are counts, states and names, and must be the same. Others may be off by a
part of themselves; where they were rounded for people, by one in the last digit too.
"""

import difflib
import re
from collections.abc import Iterator
from dataclasses import dataclass

_NUMBER = re.compile(
    r"(?P<room>\ *)(?<![\w.])(?P<number>[-+−±]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)(?![\w.]*\d)"
)
# What people read, and where numbers are therefore rounded.
_FOR_PEOPLE = ("--- shown", "--- standard error", ".html", ".svg")
# Where numbers are written for programs, one in the last digit is no more than this part of them.
_FINEST = 1e-7


@dataclass(frozen=True)
class Tolerance:
    """How far numbers may be off: a part of themselves, and the smallest that counts."""

    relative: float
    absolute: float


# Of statics: another BLAS library, or another order of a sum, changes the last digits.
EXACT = Tolerance(1e-9, 1e-11)
# Of fits by least squares, which stop where a step gains less than about this.
FITTED = Tolerance(1e-6, 1e-8)
# Of MuJoCo: every contact enlarges what rounding began. Where the state at the start of each piece
# of a walk is off by 1e-15 of itself, work and distance are off by up to 1e-5 of themselves, and
# the turn of a robot that walks straight on by up to 3e-5 degrees.
SIMULATED = Tolerance(1e-4, 1e-4)


def differences(frozen: str, found: str, tolerance: Tolerance) -> list[str]:
    """A unified diff of the lines that differ by more than numbers may; empty where none does."""
    if frozen == found:
        return []
    before, after = frozen.split("\n"), found.split("\n")
    rounded = list(_rounded(before))
    # Lines that are alike are made the same, so that the diff shows only the others.
    matcher = difflib.SequenceMatcher(None, before, after, autojunk=False)
    for kind, a, b, c, d in matcher.get_opcodes():
        if kind == "replace":
            for k in range(min(b - a, d - c)):
                if alike(before[a + k], after[c + k], tolerance, rounded=rounded[a + k]):
                    after[c + k] = before[a + k]
    return list(difflib.unified_diff(before, after, "frozen", "found", lineterm="", n=2))


def alike(frozen: str, found: str, tolerance: Tolerance, *, rounded: bool) -> bool:
    """Whether two lines say the same, but for what numbers may be off."""
    if frozen == found:
        return True
    if _NUMBER.sub("#", frozen) != _NUMBER.sub("#", found):
        return False
    pairs = zip(_NUMBER.finditer(frozen), _NUMBER.finditer(found), strict=True)
    return all(_close(one, other, tolerance, rounded) for one, other in pairs)


def _rounded(lines: list[str]) -> Iterator[bool]:
    """Of each line, whether its numbers were rounded for people."""
    told = False
    for line in lines:
        if line.startswith(("--- ", "$ ")):
            told = line.startswith(_FOR_PEOPLE[:2]) or line.endswith(_FOR_PEOPLE[2:])
        # JSON on the screen is not for people.
        told = told and not line.startswith("(JSON")
        yield told


def _close(one: re.Match[str], other: re.Match[str], tolerance: Tolerance, rounded: bool) -> bool:
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
    if not rounded:
        last = min(last, _FINEST * size)
    return abs(x - y) <= max(tolerance.absolute, tolerance.relative * size, last)


def _has_point(number: str) -> bool:
    return "." in number or "e" in number.lower()


def _value(text: str) -> float:
    return float(text.replace("−", "-").lstrip("±"))


def _last(text: str) -> float:
    """One in the last digit of a number as it is written."""
    digits, _, exponent = text.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
