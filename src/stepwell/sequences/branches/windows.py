"""How far off given turning points of an actuator may be."""

from __future__ import annotations

from itertools import pairwise

from stepwell.mechanism import Chain
from stepwell.sequences.branches.branches import reach
from stepwell.statics import Configuration, EventKind, path


def windows(
    chain: Chain, start: str, turning_points: tuple[float, ...]
) -> list[tuple[float, float]]:
    """For every turning point but the first and the last, drives that do the same.

    Turning anywhere after the snap before and ahead of the snap to come leads back along the
    same branch. With friction it does not, and a turning point has no window.

    Args:
        chain: what is driven.
        start: the state at the beginning.
        turning_points: from the beginning to the end [m], or [N] under force control.
    """
    inner = turning_points[1:-1]
    if any(cell.friction > 0 for cell in chain.cells):
        return [(point, point) for point in inner]
    begin: str | Configuration = start
    limits = reach(chain)
    found: list[tuple[float, float]] = []
    for before, point in pairwise(turning_points[:-1]):
        rises = point > before
        end = max(point, limits[1]) if rises else min(point, limits[0])
        whole = path(chain, [before, end], start=begin)
        snaps = [event.drive for event in whole.events if event.kind is EventKind.SNAP]
        done = [drive for drive in snaps if (drive <= point) == rises or drive == point]
        ahead = [drive for drive in snaps if drive not in done]
        last = done[-1] if done else before
        next_ = ahead[0] if ahead else whole.turning_points[-1]
        found.append((min(last, next_), max(last, next_)))
        begin = path(chain, [before, point], start=begin).end_configuration
    return found
