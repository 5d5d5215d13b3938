"""Where a chain stands in a state: every cell in its phase, all at one force."""

import math
from collections.abc import Sequence
from itertools import chain as flatten
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, told_in
from stepwell.mechanism import Chain, Stretch, ends_of
from stepwell.statics.following import Problem, of_curve, travel_between, travels_between
from stepwell.statics.problem import problem_of

# Beyond the last force at which a cell goes on to another phase, as a share of all forces.
_BEYOND = 0.05
# How far within the forces of a state it is stood in, as a share of them.
_WITHIN = 1e-3


class Configuration(NamedTuple):
    """Where the cells of a chain stand."""

    travel: tuple[float, ...]  # (N,) [m]
    sheet: tuple[int, ...]  # (N,) of their curves


def read_state(chain: Chain, name: str, state: str) -> tuple[int, ...]:
    """The phases that a state such as "010" names; raises ValueError where it names none."""
    counts = [len(stretches) for stretches in chain.stretches]
    wrong = len(state) != len(counts)
    for digit, count in zip(state, counts, strict=False):
        wrong = wrong or not (digit.isascii() and digit.isdecimal() and int(digit) < count)
    if wrong:
        most, allowed, own = max(counts), "0 or 1", ""
        if counts != [2] * len(counts):
            allowed, own = f"0 to {most - 1}", ", each the phase of a cell"
        if min(counts) < most:
            each = zip(chain.names, counts, strict=True)
            own += f" ({', '.join(f'{cell} has {n}' for cell, n in each)})"
        raise InputError(
            f"{name} = {state!r}: must be {len(counts)} characters {allowed}, inner cell "
            f"first{own}."
        )
    return tuple(map(int, state))


def place_at(chain: Chain, problem: Problem, state: str, drive: float) -> Configuration:
    """Where the chain stands in a state with the actuator at `drive` [m], or [N].

    Raises:
        ValueError: a state that the chain cannot have, or in which it does not stand at that drive.
    """
    phases = read_state(chain, "start", state)
    stretches = [own[k] for own, k in zip(chain.stretches, phases, strict=True)]
    if all(low == high for _, low, high in stretches):
        return _place(np.array([low for _, low, _ in stretches]), stretches)
    low, high = _forces(chain, problem, phases)
    if low > high:
        # Whoever begins there is told what does not balance.
        return _place(_at(problem, stretches, 0.5 * (low + high)), stretches)

    def gap(travel: Floats, force: float) -> float:
        return _drive(problem, travel, force) - drive

    first, last = _at(problem, stretches, low), _at(problem, stretches, high)
    below, above = gap(first, low), gap(last, high)
    slip = problem.alpha * 1e-9 * chain.full_stroke + problem.beta * 1e-9 * problem.scale
    if below > slip or above < -slip:
        _refuse_drive(chain, state, drive, drive + below, drive + above)
    for step in range(200):
        if above - below <= 1e-3 * slip or not low < high:
            break
        share = 0.5 if step % 3 == 2 else min(max(-below / (above - below), 0.0), 1.0)
        force = low + share * (high - low)
        if not low < force < high:
            force = 0.5 * (low + high)
            if not low < force < high:
                break
        travel = _at(problem, stretches, force)
        here = gap(travel, force)
        if here <= 0.0:
            low, first, below = force, travel, here
        if here >= 0.0:
            high, last, above = force, travel, here
    # Where a force is constant the travel is not told by it: what is left of the drive does.
    share = min(max(-below / (above - below), 0.0), 1.0) if above > below else 0.0
    return _place(first + share * (last - first), stretches)


def drive_range(chain: Chain, problem: Problem | None = None) -> tuple[float, float]:
    """Drives [m], or [N] under force control, that pull every cell to its first and last phase.

    Args:
        chain: what is driven.
        problem: the problem that it sets, where it is at hand.

    Raises:
        StaticsError: a force that turns too often to follow.
    """
    _, (low, high) = full_range(chain, problem or problem_of(chain))
    return low, high


def full_range(chain: Chain, problem: Problem) -> tuple[Configuration, tuple[float, float]]:
    """Where a full cycle begins, and the drives between which it goes.

    Stops end what a rigid actuator can do. Any other, and one that pulls curves with open ends,
    goes a little beyond all forces at which a cell leaves a phase.
    """
    laws, pieces = problem.laws, problem.pieces
    if not chain.elements or (problem.beta == 0 and all(all(c.stopped) for c in chain.cells)):
        low, high = ends_of(problem.sheets)
        begin = _place(
            np.array([cell.low for cell in chain.cells]), [own[0] for own in chain.stretches]
        )
        if problem.beta == 0:
            return begin, (low, high)
        # A force below which no cell leaves 0, and one above which none leaves 1.
        forces = np.concatenate([pieces.force_left, pieces.force_right])
        rub, margin = float(np.max(laws.friction)), 0.01 * problem.scale
        least, most = float(np.min(forces)) - rub - margin, float(np.max(forces)) + rub + margin
        reach = problem.alpha * high
        return begin, (problem.beta * least, reach + problem.beta * most)
    forces = np.fromiter(
        flatten.from_iterable([cell.switching_range for cell in chain.cells]), float
    )
    forces = forces[np.isfinite(forces)]
    if not forces.size:
        own = of_curve(problem.sheets, pieces)
        forces = np.concatenate([pieces.force_left[own], pieces.force_right[own]])
    more = _BEYOND * problem.scale + float(np.max(laws.friction))
    least = min(0.0, float(np.min(forces)) - more)
    most = max(0.0, float(np.max(forces)) + more)
    stretches = [cell.stretches for cell in chain.cells]
    first, last = [own[0] for own in stretches], [own[-1] for own in stretches]
    begin, end = _at(problem, first, least), _at(problem, last, most)
    ends = _drive(problem, begin, least), _drive(problem, end, most)
    return _place(begin, first), ends


def standing(chain: Chain, problem: Problem, state: str) -> tuple[Configuration, float] | None:
    """Where the chain stands in a state under the force nearest to none, and the drive there.

    None where no force holds all cells in these phases.

    Raises:
        ValueError: a state that the chain cannot have.
    """
    phases = read_state(chain, "state", state)
    low, high = _forces(chain, problem, phases)
    if low > high:
        return None
    stretches = [own[k] for own, k in zip(chain.stretches, phases, strict=True)]
    # Where a stretch ends, only just nothing holds the cell; a stop does.
    within = 0.0 if all(a == b for _, a, b in stretches) else _WITHIN * (high - low)
    force = min(max(0.0, low + within), high - within)
    travel = _at(problem, stretches, force)
    return _place(travel, stretches), _drive(problem, travel, force)


def _place(travel: Floats, stretches: Sequence[Stretch]) -> Configuration:
    return Configuration(tuple(travel.tolist()), tuple([one[0] for one in stretches]))


def _drive(problem: Problem, travel: Floats, force: float) -> float:
    return problem.alpha * math.fsum(travel.tolist()) + problem.beta * force


def _forces(chain: Chain, problem: Problem, phases: Sequence[int]) -> tuple[float, float]:
    """Forces between which all cells stay in these phases [N], as far as open ends go on."""
    own = [cell[k] for cell, k in zip(chain.phases, phases, strict=True)]
    rub = problem.laws.friction.tolist()
    low = max(phase.force_low - f for phase, f in zip(own, rub, strict=True))
    high = min(phase.force_high + f for phase, f in zip(own, rub, strict=True))
    pieces = problem.pieces
    reach = float(max(np.max(pieces.force_right), np.max(-pieces.force_left))) + problem.scale
    return max(low, -reach), min(high, reach)


def _at(problem: Problem, stretches: Sequence[Stretch], force: float) -> Floats:
    """(N,) travels in these phases at a force [m]; at an end of the phase past its forces."""
    found = np.empty(len(stretches))
    numbers = np.fromiter(flatten.from_iterable(stretches), float).reshape(-1, 3)
    travels_between(*problem[:3], numbers, force, found)
    return found


def travel_in(problem: Problem, cell: int, stretch: Stretch, force: float) -> float:
    """Travel of a cell in a phase at a force [m]; at an end of the phase past its forces."""
    return float(travel_between(*problem[:3], cell, stretch, force))


def _refuse_drive(chain: Chain, state: str, drive: float, low: float, high: float) -> None:
    unit, factor = told_in(chain.drive_unit)
    raise InputError(
        f"turning_points[0] = {drive * factor:.9g} {unit}: in the state {state} the chain stands "
        f"from {low * factor:.9g} to {high * factor:.9g} {unit}; begin "
        f"there, or pass another start."
    )
