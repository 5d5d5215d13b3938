"""Advice where a band is too long for the lever: sizes with which a choice of holes exists."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise

from stepwell.base import from_unit, to_unit
from stepwell.design.synthesis.attempt import Attempt, possible
from stepwell.design.synthesis.candidates import Rule
from stepwell.design.synthesis.region import Region, drilled
from stepwell.mechanism import sizes

Regions = tuple[Region, ...]
RegionsOf = Callable[[float], Regions]
"""The regions of all cells for a lever [m]."""

# Tried sizes: each about a tenth from the one before, within a factor of about four.
_STEP, _TRIED = 1.1, 15


def slack_advice(attempt: Attempt, regions_of: RegionsOf) -> tuple[str, str]:
    """How many holes leave the only kind of band slack, and which sizes leave a choice of holes.

    Both are empty if no hole leaves it slack, or with several kinds. Every size was searched: with
    it, and all else unchanged, a choice of holes meets the target orders.
    """
    if attempt.holes is None or len(attempt.rule.kinds) != 1:
        return "", ""
    (kind,) = attempt.rule.kinds
    places = [drilled(region, attempt.holes) for region in dict.fromkeys(attempt.regions)]
    ways = sum(len(q) for q in places)
    slack = sum(int((~kind.taut(attempt.rule.differences(q))).sum()) for q in places)
    if not slack:
        return "", ""
    found = f"the band is slack in a part of the travel at {slack} of {ways} holes"
    lever, rest = _enough_lever(attempt, regions_of), _enough_rest(attempt)
    parts = [f"a lever of {to_unit(lever, 'mm'):.4g} mm"] if lever else []
    parts += [f"a rest length of {to_unit(rest, 'mm'):.4g} mm"] if rest else []
    if not parts:
        return found, ""
    return found, f"{' or '.join(parts)} leaves a choice of holes in the target orders"


def _enough_lever(attempt: Attempt, regions_of: RegionsOf) -> float | None:
    (kind,) = attempt.rule.kinds
    for lever in _rounded(kind.lever, _STEP):
        if _looks_wrong(attempt, lever, kind.band.rest_length):
            break
        regions = regions_of(lever)
        scaled = regions != attempt.regions
        box = regions[0].bounds if scaled else attempt.rule.looked_at
        rule = replace(attempt.rule, kinds=(replace(kind, lever=lever),), looked_at=box)
        if _possible(attempt, rule, regions):
            return lever
    return None


def _enough_rest(attempt: Attempt) -> float | None:
    (kind,) = attempt.rule.kinds
    for rest in _rounded(kind.band.rest_length, 1 / _STEP):
        if _looks_wrong(attempt, kind.lever, rest):
            break
        shorter = replace(kind, band=replace(kind.band, rest_length=rest))
        if _possible(attempt, replace(attempt.rule, kinds=(shorter,)), attempt.regions):
            return rest
    return None


def _looks_wrong(attempt: Attempt, lever: float, rest: float) -> bool:
    """Whether `design` would refuse these sizes as unit errors."""
    if attempt.rule.kinds[0].unusual:
        return False
    pitch = attempt.holes.pitch if attempt.holes else 0.0
    lengths = pitch, attempt.rule.fixed, rest
    slips = [slip for length in lengths for slip in sizes.length("", length, lever)]
    return bool(slips) or any(sizes.lever_of("", lever))


def _possible(attempt: Attempt, rule: Rule, regions: Regions) -> bool:
    return possible(rule, attempt.orders, regions, attempt.holes)


def _rounded(size: float, step: float) -> Iterator[float]:
    """Sizes [m] from one on, away from it, of two digits in millimetres."""
    size_mm = to_unit(size, "mm")
    away = math.ceil if step > 1 else math.floor
    tried = [size_mm]
    for k in range(1, _TRIED + 1):
        now = size_mm * step**k
        digit = 10.0 ** (math.floor(math.log10(now)) - 1)
        tried.append(round(away(now / digit) * digit, 9))
    yield from (from_unit(now, "mm") for before, now in pairwise(tried) if now != before)
