"""Bounds of the travels in a snap: by the forces on the cells, and by the available energy."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import BEFORE, BEYOND, HIGH, LOW, stored
from stepwell.statics.following.pieces import find_piece, invert
from stepwell.statics.following.state import DrivenChain, force_at
from stepwell.statics.landings.start import Start

# Tolerances of forces, as a fraction of the largest, and of travels, of the full ones: far above
# rounding and far below the precision of a mechanism.
CLOSE_FORCE, CLOSE = 1e-10, 1e-12
# Rounds after which cells with growing bounds get their full travel.
_ROUNDS = 64


class ReachableBox(NamedTuple):
    """Bounds of the travels of every cell in the snap; N cells."""

    low: Floats  # (N,)
    high: Floats  # (N,)
    stops: Ints  # (N, 2) whether it is pressed against a stop at `low`, at `high`
    force: Floats  # (2,) least and largest λ


@kernel
def forces_within(problem: DrivenChain, i: int, low: float, high: float) -> tuple[float, float]:
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
def _pushed(problem: DrivenChain, i: int, travel: float, level: float, up: bool) -> float:
    """The farthest travel, up or down, to which a force can bring cell i."""
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
def full_box(problem: DrivenChain, start: Start) -> ReachableBox:
    """All travels of the sheets on which the cells stand, and all forces."""
    n, ends = len(start.travel), problem.sheets.ends
    box = ReachableBox(
        ends[:, LOW].copy(), ends[:, HIGH].copy(), np.ones((n, 2), np.int64), np.empty(2)
    )
    least, most, below, above = start.force, start.force, 0.0, 0.0
    for i in range(n):
        low, high = forces_within(problem, i, box.low[i], box.high[i])
        least, most = min(least, low), max(most, high)
        below += box.low[i] - start.travel[i]
        above += box.high[i] - start.travel[i]
    if problem.beta > 0.0:
        stiffness = problem.alpha / problem.beta
        least = min(least, start.force - stiffness * above)
        most = max(most, start.force - stiffness * below)
    box.force[0], box.force[1] = least, most
    return box


@kernel
def leads_on(problem: DrivenChain, box: ReachableBox) -> bool:
    """Whether some cell can reach a fold of its curve, and jump."""
    ends = problem.sheets.ends
    for i in range(len(box.low)):
        if box.high[i] > box.low[i] and (
            (box.stops[i, 0] and ends[i, BEFORE] < ends[i, LOW])
            or (box.stops[i, 1] and ends[i, BEYOND] > ends[i, HIGH])
        ):
            return True
    return False


@kernel
def narrowed_box(problem: DrivenChain, start: Start, within: ReachableBox) -> ReachableBox:
    """Box that overdamped flow never leaves, for all mobilities, within a box known before."""
    # λ stays between the forces of the moving cells, friction added, and a cell stays short of the
    # travel at which it resists the largest λ: the smallest box closed under both is never left.
    laws, alpha, beta = problem.laws, problem.alpha, problem.beta
    n, slip = len(start.travel), CLOSE_FORCE * problem.scale
    box = ReachableBox(
        within.low.copy(), within.high.copy(), within.stops.copy(), within.force.copy()
    )
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
            box.high[i], box.low[i] = min(up, within.high[i]), max(down, within.low[i])
            below += box.low[i] - s
            above += box.high[i] - s
            if box.high[i] > box.low[i] and beta == 0.0:
                low, high = forces_within(problem, i, box.low[i], box.high[i])
                new_least, new_most = min(new_least, low + rub), max(new_most, high - rub)
        if beta > 0.0:
            new_least = min(new_least, start.force - alpha / beta * above)
            new_most = max(new_most, start.force - alpha / beta * below)
            new_least, new_most = max(new_least, within.force[0]), min(new_most, within.force[1])
        if new_least >= least and new_most <= most:
            break
        if turn > 16:
            # Bounds that converge slowly are extended a little further.
            new_least -= 0.1 * (least - new_least)
            new_most += 0.1 * (new_most - most)
        least, most = new_least, new_most
    box.force[0], box.force[1] = least, most
    for i in range(n):
        near, low, high = CLOSE * laws.full[i], within.low[i], within.high[i]
        below, above = box.low[i] <= low + near, box.high[i] >= high - near
        box.low[i], box.high[i] = low if below else box.low[i], high if above else box.high[i]
        box.stops[i, 0] *= below
        box.stops[i, 1] *= above
    return box


# Steps on the widest box.
_STEPS = 64


@kernel
def energy_at(problem: DrivenChain, start: Start, i: int, travel: float) -> float:
    """Energy that cell i has stored since the start, less λ of the start times its way [J]."""
    pieces, begun = problem.pieces, start.travel[i]
    picked = pieces.picked
    here = stored(problem.laws, i, picked[find_piece(pieces, i, travel, 0)], travel)
    there = stored(problem.laws, i, picked[find_piece(pieces, i, begun, 0)], begun)
    return here - there - start.force * (travel - begun)


@kernel
def energy_of(problem: DrivenChain, start: Start, travel: Floats) -> float:
    """Energy that the chain and its actuator have stored at `travel` (N,) since the start [J]."""
    total, way = 0.0, 0.0
    for i in range(len(travel)):
        total += energy_at(problem, start, i, travel[i])
        way += travel[i] - start.travel[i]
    if problem.beta > 0.0:
        total += 0.5 * problem.alpha / problem.beta * way * way
    return total


@kernel
def energy_slack(problem: DrivenChain) -> float:
    """Energies that are closer than this differ by rounding [J]."""
    return CLOSE_FORCE * problem.scale * np.max(problem.laws.full)


@kernel
def least_energy(
    energy: tuple[float, float], width: float, force: tuple[float, float], tilt: float
) -> float:
    """Lower bound of the energy between two travels, less `tilt` times the way."""
    one, two = energy[0], energy[1] - tilt * width
    falls, rises = force[0] - tilt, force[1] - tilt
    if falls >= 0.0:
        return one
    if rises <= 0.0:
        return two
    way = min(max((one - two + rises * width) / (rises - falls), 0.0), width)
    return one + falls * way


@kernel
def _cheapest(one: Floats, two: Floats) -> Floats:
    """Least sums of two energies, for every sum of their places."""
    out = np.full(len(one) + len(two) - 1, np.inf)
    for j in range(len(one)):
        for k in range(len(two)):
            out[j + k] = min(out[j + k], one[j] + two[k])
    return out


@kernel
def narrow(problem: DrivenChain, start: Start, box: ReachableBox) -> None:
    """Remove from a box all travels that need more energy than there is at the start."""
    # Each cell is combined with the least energy of all others at that drive, in equal steps.
    # One function: each cell needs the energies of all others, made once.
    moving = np.flatnonzero(box.high > box.low)
    m, level = len(moving), start.force
    if m == 0:
        return
    rigid = problem.beta == 0.0
    stiffness = 0.0 if rigid else problem.alpha / problem.beta
    step, energies = np.max(box.high - box.low) / _STEPS, np.empty((m, _STEPS + 2))
    first, count = np.empty(m, np.int64), np.empty(m, np.int64)
    for k in range(m):
        i, s = int(moving[k]), start.travel[moving[k]]
        first[k] = int(np.floor((box.low[i] - s) / step + 1e-9))
        count[k] = max(1, int(np.ceil((box.high[i] - s) / step - 1e-9)) - first[k])
        for j in range(count[k]):
            a = float(max(box.low[i], s + (first[k] + j) * step))
            b = float(min(box.high[i], s + (first[k] + j + 1) * step))
            least, most = forces_within(problem, i, a, b)
            ends = energy_at(problem, start, i, a), energy_at(problem, start, i, b)
            energies[k, j] = least_energy(ends, b - a, (least - level, most - level), 0.0)
    slack, lowest, highest = energy_slack(problem), np.inf, -np.inf
    before, from_before = np.zeros(1), 0
    for k in range(m):
        after, from_after = np.zeros(1), 0
        for j in range(m - 1, k, -1):
            after = _cheapest(after, energies[j, : count[j]])
            from_after += first[j]
        others, begin = _cheapest(before, after), from_before + from_after
        before = _cheapest(before, energies[k, : count[k]])
        from_before += first[k]
        i, s = moving[k], start.travel[moving[k]]
        reached = np.zeros(count[k], np.bool_)
        for j in range(count[k]):
            for o in range(len(others)):
                # The sum of all ways is between this and m steps more.
                gone = first[k] + j + begin + o
                total = energies[k, j] + others[o]
                if rigid:
                    if not -m <= gone <= 0:
                        continue
                else:
                    way = max(0.0, gone * step, -(gone + m) * step)
                    total += 0.5 * stiffness * way * way
                if total <= slack:
                    reached[j] = True
                    lowest, highest = min(lowest, gone * step), max(highest, (gone + m) * step)
        up, down = -first[k], -first[k] - 1
        while up < count[k] and reached[up]:
            up += 1
        while down >= 0 and reached[down]:
            down -= 1
        if up < count[k]:
            box.high[i], box.stops[i, 1] = s + (first[k] + up) * step, 0
        if down >= 0:
            box.low[i], box.stops[i, 0] = s + (first[k] + down + 1) * step, 0
    if not rigid and highest >= lowest:
        box.force[0] = max(box.force[0], start.force - stiffness * highest)
        box.force[1] = min(box.force[1], start.force - stiffness * lowest)
