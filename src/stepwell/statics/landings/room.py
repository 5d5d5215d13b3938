"""How far the cells can go in a snap, whatever their mobilities: those that cannot move, cannot."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import BEFORE, BEYOND, HIGH, LOW, law
from stepwell.statics.following import Problem, find_piece, invert
from stepwell.statics.landings.start import Start

# Forces are told apart from here on, as a share of the largest, and travels, as a share of theirs:
# far above what rounding does to them and far below what a mechanism can.
CLOSE_FORCE, CLOSE = 1e-10, 1e-12
# Rounds after which cells that still spread are given all of their travel.
_ROUNDS = 64


class Room(NamedTuple):
    """Travels between which every cell stays in the snap; N cells."""

    low: Floats  # (N,)
    high: Floats  # (N,)
    stops: Ints  # (N, 2) whether it is pressed against a stop at `low`, at `high`
    force: Floats  # (2,) least and largest λ


@kernel
def force_at(problem: Problem, i: int, travel: float) -> float:
    """F of cell i [N]."""
    pieces = problem.pieces
    piece = find_piece(pieces, i, travel, 0)
    if travel == pieces.left[piece]:
        return pieces.force_left[piece]
    if travel == pieces.right[piece]:
        return pieces.force_right[piece]
    return law(problem.laws, i, pieces.picked[piece], travel)[0]


@kernel
def forces_within(problem: Problem, i: int, low: float, high: float) -> tuple[float, float]:
    """Least and largest F of cell i between two travels: forces are monotone on every piece."""
    pieces = problem.pieces
    one, two = force_at(problem, i, low), force_at(problem, i, high)
    least, most = min(one, two), max(one, two)
    piece = find_piece(pieces, i, low, 1)
    while piece < pieces.among[i, 1] and pieces.right[piece] < high:
        least = min(least, pieces.force_right[piece])
        most = max(most, pieces.force_right[piece])
        piece += 1
    return least, most


@kernel
def _pushed(problem: Problem, i: int, travel: float, level: float, up: bool) -> float:
    """The travel from which a force cannot bring cell i any further on its way up, or down."""
    pieces, toward = problem.pieces, 1 if up else -1
    if toward * (level - force_at(problem, i, travel)) <= 0.0:
        return travel
    piece = find_piece(pieces, i, travel, 1 if up else 0)
    while True:
        end = pieces.force_right[piece] if up else pieces.force_left[piece]
        if toward * (level - end) <= 0.0:
            reach = invert(problem.laws, pieces, i, piece, level)
            return max(travel, reach) if up else min(travel, reach)
        if piece == (pieces.among[i, 1] if up else pieces.among[i, 0]):
            return pieces.right[piece] if up else pieces.left[piece]
        piece += toward


@kernel
def whole_room(problem: Problem, start: Start) -> Room:
    """All travels of the sheets on which the cells stand, and all forces."""
    n, ends = len(start.travel), problem.sheets.ends
    room = Room(ends[:, LOW].copy(), ends[:, HIGH].copy(), np.ones((n, 2), np.int64), np.empty(2))
    least, most, below, above = start.force, start.force, 0.0, 0.0
    for i in range(n):
        low, high = forces_within(problem, i, room.low[i], room.high[i])
        least, most = min(least, low), max(most, high)
        below += room.low[i] - start.travel[i]
        above += room.high[i] - start.travel[i]
    if problem.beta > 0.0:
        stiffness = problem.alpha / problem.beta
        least = min(least, start.force - stiffness * above)
        most = max(most, start.force - stiffness * below)
    room.force[0], room.force[1] = least, most
    return room


@kernel
def leads_on(problem: Problem, room: Room) -> bool:
    """Whether some cell can come to where its curve folds back, and jump."""
    ends = problem.sheets.ends
    for i in range(len(room.low)):
        if room.high[i] > room.low[i] and (
            (room.stops[i, 0] and ends[i, BEFORE] < ends[i, LOW])
            or (room.stops[i, 1] and ends[i, BEYOND] > ends[i, HIGH])
        ):
            return True
    return False


@kernel
def room_of(problem: Problem, start: Start, within: Room) -> Room:
    """The room of overdamped flow, for all mobilities, within one that it is known not to leave.

    λ stays between the least and the largest force of the cells that move, friction added; a cell
    stays short of where its force holds the largest λ. The smallest room that is closed under both
    is never left.
    """
    laws, alpha, beta = problem.laws, problem.alpha, problem.beta
    n, slip = len(start.travel), CLOSE_FORCE * problem.scale
    room = Room(within.low.copy(), within.high.copy(), within.stops.copy(), within.force.copy())
    least, most = start.force, start.force
    for turn in range(_ROUNDS):
        if turn == _ROUNDS - 1:
            rub = np.max(laws.friction)
            least, most = within.force[0] - rub, within.force[1] + rub
        new_least, new_most, below, above = least, most, 0.0, 0.0
        for i in range(n):
            s, rub = start.travel[i], laws.friction[i]
            up = _pushed(problem, i, s, most - rub + slip, True)
            down = _pushed(problem, i, s, least + rub - slip, False)
            room.high[i], room.low[i] = min(up, within.high[i]), max(down, within.low[i])
            below += room.low[i] - s
            above += room.high[i] - s
            if room.high[i] > room.low[i] and beta == 0.0:
                low, high = forces_within(problem, i, room.low[i], room.high[i])
                new_least, new_most = min(new_least, low + rub), max(new_most, high - rub)
        if beta > 0.0:
            new_least = min(new_least, start.force - alpha / beta * above)
            new_most = max(new_most, start.force - alpha / beta * below)
            new_least, new_most = max(new_least, within.force[0]), min(new_most, within.force[1])
        if new_least >= least and new_most <= most:
            break
        if turn > 16:
            # What spreads by ever smaller steps is given a little more than it asks for.
            new_least -= 0.1 * (least - new_least)
            new_most += 0.1 * (new_most - most)
        least, most = new_least, new_most
    room.force[0], room.force[1] = least, most
    for i in range(n):
        near = CLOSE * laws.full[i]
        if room.low[i] <= within.low[i] + near:
            room.low[i] = within.low[i]
        else:
            room.stops[i, 0] = 0
        if room.high[i] >= within.high[i] - near:
            room.high[i] = within.high[i]
        else:
            room.stops[i, 1] = 0
    return room
