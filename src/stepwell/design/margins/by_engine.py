"""The smallest change of anchor or stiffness, for chains without a closed form, by asking."""

import math
from collections.abc import Callable

from stepwell.concave import SortedChain
from stepwell.design.margins.change import Change, shifted, stiffened
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle
from stepwell.statics import StaticsError

_RINGS = 12  # the widest is the reach, each the half of the next
_DIRECTIONS = 16
_FINE = 1e-6  # m, or the same fraction of the stiffness: where bisection stops
_STIFFEST = 8.0  # largest ratio of stiffness tried, up and down

RESOLUTION = (
    f"{_RINGS} rings of {_DIRECTIONS} anchors, each half as wide as the next, and as many "
    f"stiffnesses up to {_STIFFEST:g} times more and less; a change that comes and goes between "
    f"two of them is not seen; then bisection to {_FINE * 1e3:g} mm or {_FINE * 100:g} %"
)


def sequence(chain: Chain) -> Sequence:
    """What the chain does, in closed form where it holds, else by the general engine."""
    forces = SortedChain.of(chain)
    if forces is None:
        return cycle(chain).sequence
    return Sequence.full_cycle(forces.loading, forces.unloading)


def anchor(chain: Chain, now: Sequence, cell: int, reach: float) -> Change:
    """The smallest displacement of a cell's anchor found to change the sequence `now`."""

    def changed(move: tuple[float, float]) -> bool:
        # A design that cannot be made, or that the engine cannot follow, is no longer this one.
        try:
            return sequence(shifted(chain, cell, move)) != now
        except (ValueError, StaticsError):
            return True

    def at(angle: float, away: float) -> tuple[float, float]:
        return away * math.cos(angle), away * math.sin(angle)

    def first(angle: float, low: float, high: float) -> float:
        return _bisected(lambda away: changed(at(angle, away)), low, high)

    step = 2 * math.pi / _DIRECTIONS
    for ring in range(_RINGS):
        high = reach * 0.5 ** (_RINGS - 1 - ring)
        low = high / 2 if ring else 0.0
        hits = [i * step for i in range(_DIRECTIONS) if changed(at(i * step, high))]
        if hits:
            break
    else:
        return Change(chain, cell, "anchor", math.inf, (math.nan, math.nan), "search", math.nan)
    best, heading = min((first(angle, low, high), angle) for angle in hits)
    # Turn the best ray to either side as long as that shortens it.
    while step > 1e-3:
        step /= 2
        for angle in (heading - step, heading + step):
            if changed(at(angle, best - _FINE)):
                best, heading = first(angle, low if low < best else 0.0, best - _FINE), angle
                break
    return Change(chain, cell, "anchor", best, at(heading, best), "search", at(heading, best))


def stiffness(chain: Chain, now: Sequence, cell: int) -> Change:
    """The smallest relative change of a cell's stiffness found to change the sequence `now`."""

    def changed(fraction: float) -> bool:
        try:
            return sequence(stiffened(chain, cell, 1.0 + fraction)) != now
        except StaticsError:
            return True

    found: list[float] = []
    for sign in (1, -1):
        low = 0.0
        for ring in range(_RINGS):
            ratio = _STIFFEST ** (0.5 ** (_RINGS - 1 - ring))
            high = ratio - 1.0 if sign > 0 else 1.0 - 1.0 / ratio
            if changed(sign * high):
                found.append(
                    sign * _bisected(lambda size, sign=sign: changed(sign * size), low, high)
                )
                break
            low = high
    if not found:
        return Change(chain, cell, "stiffness", math.inf, math.nan, "search", math.nan)
    move = min(found, key=abs)
    return Change(chain, cell, "stiffness", abs(move), move, "search", move)


def _bisected(changed: Callable[[float], bool], low: float, high: float) -> float:
    # Returns the upper end, where the change is known to have happened.
    while high - low > _FINE:
        middle = (low + high) / 2
        if changed(middle):
            high = middle
        else:
            low = middle
    return high
