"""How far the cells can go with the energy that there is, whoever gives and whoever takes."""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import kernel
from stepwell.mechanism import stored
from stepwell.statics.following import Problem, find_piece
from stepwell.statics.landings.room import CLOSE_FORCE, Room, forces_within
from stepwell.statics.landings.start import Start

# Steps on the widest room.
_STEPS = 64


@kernel
def energy_at(problem: Problem, start: Start, i: int, travel: float) -> float:
    """What cell i has stored since the start, less λ of the start times the way [J]."""
    pieces, begun = problem.pieces, start.travel[i]
    picked = pieces.picked
    here = stored(problem.laws, i, picked[find_piece(pieces, i, travel, 0)], travel)
    there = stored(problem.laws, i, picked[find_piece(pieces, i, begun, 0)], begun)
    return here - there - start.force * (travel - begun)


@kernel
def energy_of(problem: Problem, start: Start, travel: Floats) -> float:
    """What the chain and its actuator have stored at `travel` (N,) since the start [J]."""
    total, way = 0.0, 0.0
    for i in range(len(travel)):
        total += energy_at(problem, start, i, travel[i])
        way += travel[i] - start.travel[i]
    if problem.beta > 0.0:
        total += 0.5 * problem.alpha / problem.beta * way * way
    return total


@kernel
def energy_slack(problem: Problem) -> float:
    """Energies that are closer than this differ by rounding [J]."""
    return CLOSE_FORCE * problem.scale * np.max(problem.laws.full)


@kernel
def least_energy(
    energy: tuple[float, float], width: float, force: tuple[float, float], tilt: float
) -> float:
    """A bound from below of energy between two travels, less `tilt` times the way from the first.

    From the energies at both and the least and the largest F between them, less λ of the start.
    """
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
    """For every sum of two places the least sum of their energies."""
    out = np.full(len(one) + len(two) - 1, np.inf)
    for j in range(len(one)):
        for k in range(len(two)):
            out[j + k] = min(out[j + k], one[j] + two[k])
    return out


@kernel
def narrow(problem: Problem, start: Start, room: Room) -> None:
    """Take off a room what the chain cannot come to without more energy than at the start.

    Each cell is given the cheapest that all others can do at the same drive. Travels are counted
    from the start in steps, so that those of all cells add up; each bound holds for a whole step.
    """
    moving = np.flatnonzero(room.high > room.low)
    m, level = len(moving), start.force
    if m == 0:
        return
    rigid = problem.beta == 0.0
    stiffness = 0.0 if rigid else problem.alpha / problem.beta
    step = np.max(room.high - room.low) / _STEPS
    first, count = np.empty(m, np.int64), np.empty(m, np.int64)
    energies = np.empty((m, _STEPS + 2))
    for k in range(m):
        i = int(moving[k])
        s = start.travel[i]
        first[k] = int(np.floor((room.low[i] - s) / step + 1e-9))
        count[k] = max(1, int(np.ceil((room.high[i] - s) / step - 1e-9)) - first[k])
        for j in range(count[k]):
            a = float(max(room.low[i], s + (first[k] + j) * step))
            b = float(min(room.high[i], s + (first[k] + j + 1) * step))
            least, most = forces_within(problem, i, a, b)
            ends = energy_at(problem, start, i, a), energy_at(problem, start, i, b)
            energies[k, j] = least_energy(ends, b - a, (least - level, most - level), 0.0)
    slack = energy_slack(problem)
    lowest, highest = np.inf, -np.inf
    before = np.zeros(1)
    from_before = 0
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
                # All together have gone between this and m steps more.
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
        here = -first[k]
        up = here
        while up < count[k] and reached[up]:
            up += 1
        down = here - 1
        while down >= 0 and reached[down]:
            down -= 1
        if up < count[k]:
            room.high[i], room.stops[i, 1] = s + (first[k] + up) * step, 0
        if down >= 0:
            room.low[i], room.stops[i, 0] = s + (first[k] + down + 1) * step, 0
    if not rigid and highest >= lowest:
        room.force[0] = max(room.force[0], start.force - stiffness * highest)
        room.force[1] = min(room.force[1], start.force - stiffness * lowest)
