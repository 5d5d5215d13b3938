"""How wide figures are in print."""

from __future__ import annotations

import difflib
import math
import re
from types import MappingProxyType
from typing import NamedTuple

from stepwell.base import InputError

_MM = MappingProxyType({"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.0})
# Of pages [mm]: narrower has no room for one panel, wider is no page.
NARROWEST, WIDEST = 40.0, 400.0


class JournalWidth(NamedTuple):
    """A width of figures [mm], what it is, and where its publisher says so."""

    width: float
    what: str
    source: str


def _columns(name: str, source: str, *widths: float) -> dict[str, JournalWidth]:
    words = ("single", "double") if len(widths) == 2 else ("single", "middle", "double")
    return {
        f"{name}-{word}": JournalWidth(round(width, 1), f"{word} column", source)
        for word, width in zip(words, widths, strict=True)
    }


WIDTHS: MappingProxyType[str, JournalWidth] = MappingProxyType(
    _columns("nature", "Nature, research figure guide: figure sizing", 89.0, 183.0)
    | _columns("science", "Science, preparing figures: 5.7, 12.1, 18.4 cm", 57.0, 121.0, 184.0)
    | _columns("pnas", "PNAS, digital art guidelines: 8.7, 11.4, 17.8 cm", 87.0, 114.0, 178.0)
    | _columns("aps", "American Physical Society, Physical Review: 8.6, 17.8 cm", 86.0, 178.0)
    | _columns("acs", "American Chemical Society: 240, 504 pt", 240 * _MM["pt"], 504 * _MM["pt"])
    | _columns("elsevier", "Elsevier, artwork sizing: 90, 140, 190 mm", 90.0, 140.0, 190.0)
    | _columns("springer", "Springer, artwork: 84, 174 mm", 84.0, 174.0)
    | _columns("wiley", "Wiley, figure sizes: 80, 180 mm", 80.0, 180.0)
    | _columns("ieee", "IEEE, graphics sizing: 3.5, 7.16 in", 3.5 * 25.4, 7.16 * 25.4)
    | _columns("rsc", "Royal Society of Chemistry: 8.3, 17.1 cm", 83.0, 171.0)
)


def length(text: str) -> float:
    """A length with its unit, as "88mm", "3.5 in", "18cm" or "240pt", or a journal's name [mm].

    Raises:
        ValueError: no length, one without a unit, an unknown name, or no size of a page.
    """
    known = text.strip().lower()
    if known in WIDTHS:
        return WIDTHS[known].width
    found = re.fullmatch(r"([\d.]+)\s*([a-z]*)", known)
    try:
        value, unit = (float(found[1]), found[2]) if found else (math.nan, "")
    except ValueError:
        value, unit = math.nan, ""
    if math.isnan(value):
        near = difflib.get_close_matches(known, [*WIDTHS, *(f"{k}-single" for k in WIDTHS)], n=1)
        guess = f" Did you mean {near[0]}?" if near and near[0] in WIDTHS else ""
        names = ", ".join(WIDTHS)
        raise InputError(
            f"{text!r}: must be a length such as 88mm, 8.8cm, 3.5in or 250pt, or one of {names}."
            f"{guess}"
        )
    if unit not in _MM:
        was = f"unknown unit {unit!r}" if unit else "has no unit"
        raise InputError(f"{text!r}: {was}; write {value:g}mm, or use cm, in or pt.")
    result = value * _MM[unit]
    if not NARROWEST <= result <= WIDEST:
        raise InputError(
            f"{text!r} is {result:.4g} mm: must be {NARROWEST:g} to {WIDEST:g} mm, as pages are."
        )
    return result
