"""Stroke programs of chains with friction, which no finite graph describes: a search.

With friction a chain that turns back stays where it is until the force has crossed the band of
friction, and so every turning point leads to a place of its own. The search turns in the
middle of every smooth section of every run and goes on from there. What it finds is followed by
the engine and is right; what it does not find may exist.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial

from stepwell.base import bisected
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches, Section, passages_of, state_of
from stepwell.sequences.programs.program import Program, ProgramMethod, Turn, Unreachable
from stepwell.statics import Configuration, StaticsError, path

_MOST_TURNS = 6
_MOST_PLACES = 4000
# Places closer than this share of all that can be travelled and driven are not both tried.
_SAME = 1e-4


def search_with_friction(
    branches: Branches,
    start: str,
    to: str,
    origin: tuple[Configuration, float],
    progress: Callable[[int, int], None] | None,
    robust: float | None,
) -> Program:
    """The first program found, fewest turns first; as `sequences.program`."""
    chain = branches.chain
    least, slip = _SAME * chain.full_stroke, _SAME * (branches.range[1] - branches.range[0])
    waiting: deque[tuple[Configuration, float, int, tuple[float, ...]]] = deque()
    for direction in (+1, -1):
        waiting.append((*origin, direction, ()))
    seen: set[tuple[int, ...]] = set()
    while waiting and len(seen) < _MOST_PLACES:
        place, drive, direction, turns = waiting.popleft()
        travels = (round(s / least) for s in place.travel)
        key = (*travels, *place.sheet, round(drive / slip), direction)
        if key in seen:
            continue
        seen.add(key)
        if progress is not None:
            progress(len(seen), _MOST_PLACES)
        for section in _sections(chain, place, drive, branches.range[direction > 0]):
            if section.state == to:
                low, high = sorted(section.drive)
                found = _widened(branches, start, to, origin, turns, (low, high), robust)
                if found is not None:
                    return found
            if len(turns) < _MOST_TURNS and section.drive[0] != section.drive[1]:
                middle = sum(section.drive) / 2
                stopped = path(chain, [drive, middle], start=place).end_configuration
                waiting.append((stopped, middle, -direction, (*turns, middle)))
    raise Unreachable(
        f"no program from {start} to {to} was found: {len(seen)} places with up to {_MOST_TURNS} "
        f"turns were tried, turning in the middle of every smooth part. With friction that is a "
        f"search and no proof; without friction the answer would be certain.",
        proved=False,
    )


def _sections(chain: Chain, place: Configuration, drive: float, end: float) -> list[Section]:
    try:
        passages = passages_of(path(chain, [drive, end], start=place))
        return [section for passage in passages for section in passage.sections]
    except (StaticsError, ValueError):
        # A place between two events that balance to the last digit: others are near by.
        return []


def _widened(
    branches: Branches,
    start: str,
    to: str,
    origin: tuple[Configuration, float],
    turns: tuple[float, ...],
    ends: tuple[float, float],
    robust: float | None,
) -> Program | None:
    """The program, each window bisected with the other turns where they are.

    None where one of its landings hangs on the mobilities.
    """
    chain = branches.chain
    points = [origin[1], *turns, sum(ends) / 2]

    def works(k: int, drive: float) -> bool:
        try:
            found = path(chain, [*points[:k], drive, *points[k + 1 :]], start=origin[0])
        except (StaticsError, ValueError):
            return False
        arrives = state_of(chain.stretches, found.end_configuration) == to
        return arrives and (robust is None or all(x.holds for x in found.landings(robust)))

    if robust is not None and not works(0, points[0]):
        return None
    windows: list[Turn] = []
    for k in range(1, len(points) - 1):
        rises = points[k] > points[k - 1]
        inner = max(points[k - 1], points[k + 1]) if rises else min(points[k - 1], points[k + 1])
        outer = branches.range[1] if rises else branches.range[0]
        # The drive furthest towards each of the two at which the turn still works.
        low, high = sorted(
            far if works(k, far) else bisected(partial(works, k), points[k], far, 30)[0]
            for far in (inner, outer)
        )
        points[k] = (low + high) / 2
        windows.append(Turn(points[k], low, high, ()))
    method = ProgramMethod.FRICTION
    found = chain, start, to, origin[1], tuple(windows), *ends, method, False, origin[0]
    return Program(*found, robust)
