"""Problems for the follower: configurations of a chain in a state, and starts of a path."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from stepwell import mechanism as mech
from stepwell.base import Floats, InputError, Ints, display_unit
from stepwell.kernels import UNLIMITED, entry, leaf
from stepwell.mechanism import Cell, Chain, Laws, Sheets, Stretch
from stepwell.statics.following import log as logged, pieces as cutting, state as st
from stepwell.statics.following.branch import inverse_slope
from stepwell.statics.following.state import DrivenChain, State
from stepwell.statics.outcome import StaticsError


def drive_weights(chain: Chain) -> tuple[float, float]:
    """(α, β) of the drive coordinate U = α Σ s_i + β λ."""
    stiffness = chain.actuator_stiffness
    if math.isinf(stiffness):
        return 1.0, 0.0
    return (0.0, 1.0) if stiffness == 0 else (1.0, 1.0 / stiffness)


def problem_of(
    chain: Chain, cells: tuple[Laws, Sheets] | None = None, prefer: Sequence[int] | None = None
) -> DrivenChain:
    """The problem of a chain for the follower.

    Args:
        cells: its packed cells, if available.
        prefer: cells by falling priority for ties.

    Raises:
        ValueError: a `prefer` that does not name every cell once.
        StaticsError: a force that turns too often to follow.
    """
    laws, sheets = mech.packed(chain.cells) if cells is None else cells
    pieces = cutting.cut(laws, sheets)
    counts = np.diff(pieces.of_sheet)
    worst = int(np.argmax(counts))
    if counts[worst] > cutting.MOST_PIECES:
        cell = int(np.searchsorted(np.unique(sheets.table[:, mech.FIRST]), worst, side="right")) - 1
        key = f"noise_{display_unit(chain.measure.force_unit)[0]}"
        advice = "Check for a band whose ends nearly meet."
        if isinstance(chain.cells[cell], mech.Element):
            advice = f"Smooth its table: give {key}, the standard deviation of the noise, with it."
        raise StaticsError(
            f"the {chain.measure.force} of {chain.names[cell]} has {counts[worst]} extrema or "
            f"kinks over its {chain.measure.travel}, too many to follow. {advice}"
        )
    scale, rank = cutting.force_scale(laws, sheets, pieces), _ranks(len(chain), prefer)
    weights, mobility = drive_weights(chain), mech.mobilities_of(chain.cells)
    room = np.array([0, UNLIMITED]), st.spare_memory(len(chain))
    return DrivenChain(laws, sheets, pieces, *weights, scale, rank, mobility, *room)


def _ranks(cells: int, prefer: Sequence[int] | None) -> Ints:
    if prefer is None:
        # Equal ranks: cells of constant force share the motion, else the innermost moves first.
        return np.zeros(cells, np.int64)
    order = [int(i) for i in prefer]
    if sorted(order) != list(range(cells)):
        raise InputError(
            f"prefer = {prefer!r}: must name each of the cells 0..{cells - 1} once, in the order "
            f"of priority."
        )
    ranks = np.empty(cells, np.int64)
    ranks[order] = np.arange(cells)
    return ranks


# Distance of the ends of a full cycle to the last critical force, as a fraction of all forces.
_BEYOND = 0.05
# Distance of a configuration to the critical forces of its state, as a fraction of their range.
_WITHIN = 1e-3


class Configuration(NamedTuple):
    """Travels and sheets of the cells of a chain."""

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


def place_at(chain: Chain, problem: DrivenChain, state: str, drive: float) -> Configuration:
    """Configuration of a chain in a state at `drive` [m], or [N]; ValueError where it has none."""
    phases = read_state(chain, "start", state)
    stretches = [own[k] for own, k in zip(chain.stretches, phases, strict=True)]
    if all(low == high for _, low, high in stretches):
        return _configuration(np.array([low for _, low, _ in stretches]), stretches)
    low, high = _force_range(chain, problem, phases)
    if low > high:
        # The check of the start reports the imbalance.
        return _configuration(_travels_at_force(problem, stretches, 0.5 * (low + high)), stretches)

    def look(force: float) -> _Look:
        travel = _travels_at_force(problem, stretches, force)
        return _Look(force, travel, _drive(problem, travel, force) - drive)

    first, last = look(low), look(high)
    slip = problem.alpha * 1e-9 * chain.full_stroke + problem.beta * 1e-9 * problem.scale
    if first.gap > slip or last.gap < -slip:
        _refuse_drive(chain, state, drive, drive + first.gap, drive + last.gap)
    return _configuration(_travels_at_drive(look, first, last, 1e-3 * slip), stretches)


class _Look(NamedTuple):
    """Travels (N,) [m] at a force [N], and the drive minus the requested one."""

    force: float
    travel: Floats
    gap: float


def _travels_at_drive(
    look: Callable[[float], _Look], low: _Look, high: _Look, slip: float
) -> Floats:
    """Travels (N,) [m] between two forces at which the gap is zero, to `slip`."""
    for step in range(200):
        if high.gap - low.gap <= slip or not low.force < high.force:
            break
        share = 0.5 if step % 3 == 2 else min(max(-low.gap / (high.gap - low.gap), 0.0), 1.0)
        force = low.force + share * (high.force - low.force)
        if not low.force < force < high.force:
            force = 0.5 * (low.force + high.force)
            if not low.force < force < high.force:
                break
        here = look(force)
        low, high = here if here.gap <= 0.0 else low, here if here.gap >= 0.0 else high
    # Where a force is constant it does not give the travel: what is left of the drive does.
    gaps = high.gap - low.gap
    share = min(max(-low.gap / gaps, 0.0), 1.0) if high.gap > low.gap else 0.0
    return low.travel + share * (high.travel - low.travel)


def drive_range(chain: Chain, problem: DrivenChain | None = None) -> tuple[float, float]:
    """Drives [m], or [N] under force control, that pull every cell to its first and last phase.

    Raises StaticsError for a force that turns too often to follow.
    """
    return full_range(chain, problem or problem_of(chain))[1]


def full_range(chain: Chain, problem: DrivenChain) -> tuple[Configuration, tuple[float, float]]:
    """Beginning of a full cycle, and its range of drives."""
    # A rigid actuator ends at stops; others go a little past all critical forces.
    laws, pieces = problem.laws, problem.pieces
    if not chain.elements or (problem.beta == 0 and all(all(c.stopped) for c in chain.cells)):
        (low, high), first = mech.ends_of(problem.sheets), [own[0] for own in chain.stretches]
        begin = _configuration(np.array([cell.low for cell in chain.cells]), first)
        if problem.beta == 0:
            return begin, (low, high)
        # A force below which no cell leaves 0, and one above which none leaves 1.
        forces = np.concatenate([pieces.force_left, pieces.force_right])
        rub, margin = float(np.max(laws.friction)), 0.01 * problem.scale
        least, most = float(np.min(forces)) - rub - margin, float(np.max(forces)) + rub + margin
        return begin, (problem.beta * least, problem.alpha * high + problem.beta * most)
    forces = np.array([cell.switching_range for cell in chain.cells], float)
    forces = forces[np.isfinite(forces)]
    if not forces.size:
        own = cutting.of_curve(problem.sheets, pieces)
        forces = np.concatenate([pieces.force_left[own], pieces.force_right[own]])
    more = _BEYOND * problem.scale + float(np.max(laws.friction))
    least = min(0.0, float(np.min(forces)) - more)
    most = max(0.0, float(np.max(forces)) + more)
    stretches = [cell.stretches for cell in chain.cells]
    first, last = [own[0] for own in stretches], [own[-1] for own in stretches]
    begin, end = _travels_at_force(problem, first, least), _travels_at_force(problem, last, most)
    ends = _drive(problem, begin, least), _drive(problem, end, most)
    return _configuration(begin, first), ends


def standing(chain: Chain, problem: DrivenChain, state: str) -> tuple[Configuration, float] | None:
    """Configuration and drive of a state at the smallest force in size, or None if unstable.

    Raises ValueError for a state that the chain cannot have.
    """
    phases = read_state(chain, "state", state)
    low, high = _force_range(chain, problem, phases)
    if low > high:
        return None
    stretches = [own[k] for own, k in zip(chain.stretches, phases, strict=True)]
    # At the end of a stretch the cell is marginally stable; at a stop it is stable.
    within = 0.0 if all(a == b for _, a, b in stretches) else _WITHIN * (high - low)
    force = min(max(0.0, low + within), high - within)
    travel = _travels_at_force(problem, stretches, force)
    return _configuration(travel, stretches), _drive(problem, travel, force)


def _configuration(travel: Floats, stretches: Sequence[Stretch]) -> Configuration:
    return Configuration(tuple(travel.tolist()), tuple([one[0] for one in stretches]))


def _drive(problem: DrivenChain, travel: Floats, force: float) -> float:
    return problem.alpha * math.fsum(travel.tolist()) + problem.beta * force


def _force_range(chain: Chain, problem: DrivenChain, phases: Sequence[int]) -> tuple[float, float]:
    """Forces between which all cells stay in these phases [N], within the range of open ends."""
    own = [cell[k] for cell, k in zip(chain.phases, phases, strict=True)]
    rub = problem.laws.friction.tolist()
    low = max(phase.force_low - f for phase, f in zip(own, rub, strict=True))
    high = min(phase.force_high + f for phase, f in zip(own, rub, strict=True))
    pieces = problem.pieces
    reach = float(max(np.max(pieces.force_right), np.max(-pieces.force_left))) + problem.scale
    return max(low, -reach), min(high, reach)


def _travels_at_force(problem: DrivenChain, stretches: Sequence[Stretch], force: float) -> Floats:
    """(N,) travels in these phases at a force [m]; at an end of the phase past its forces."""
    travels = np.empty(len(stretches))
    cutting.travels_between(*problem[:3], np.array(stretches, float), force, travels)
    return travels


def travel_in(problem: DrivenChain, cell: int, stretch: Stretch, force: float) -> float:
    """Travel of a cell in a phase at a force [m]; at an end of the phase past its forces."""
    return float(cutting.travel_between(*problem[:3], cell, stretch, force))


def _refuse_drive(chain: Chain, state: str, drive: float, low: float, high: float) -> None:
    unit, factor = display_unit(chain.drive_unit)
    raise InputError(
        f"turning_points[0] = {drive * factor:.9g} {unit}: the state {state} is stable from "
        f"{low * factor:.9g} to {high * factor:.9g} {unit}; begin there, or pass another start."
    )


EPSILON = float(np.finfo(float).eps)
# Largest rounding error of the spring force, as a fraction of the forces of the cells.
_BLUNT = 1e-2
# A sum of compliances below this fraction of their sizes is that of a fold.
_FOLD = 1e-5


def starting_configuration(
    chain: Chain,
    problem: DrivenChain,
    start: str | Configuration | Sequence[float] | None,
    drive: float,
) -> Configuration:
    """Configuration of a start: a state such as "010", a place, travels, or none."""
    # Raises ValueError where the chain does not have it, or has no equilibrium there at `drive`.
    if start is None or isinstance(start, str):
        return place_at(chain, problem, chain.first_state if start is None else start, drive)
    given, sheets = start if isinstance(start, Configuration) else (start, (0,) * len(chain))
    travels = np.asarray(given, float)
    if travels.shape != (len(chain),):
        raise InputError(f"start has shape {travels.shape}: must be ({len(chain)},) travels [m].")
    laws, (unit, factor) = problem.laws, display_unit(chain.measure.travel_unit)
    counts = [1 if isinstance(cell, Cell) else len(cell.sheets) for cell in chain.cells]
    named = len(sheets) == len(chain)
    if not named or any(not 0 <= k < n for k, n in zip(sheets, counts, strict=True)):
        raise InputError(
            f"start.sheet = {sheets!r}: must contain one sheet number per cell, from 0; the curves "
            f"have {', '.join(map(str, counts))} sheets."
        )
    table, now = problem.sheets.table, problem.sheets.now
    low, high = table[
        table[now, mech.FIRST].astype(int) + np.array(sheets), mech.LOW : mech.HIGH + 1
    ].T
    slip = 1e-9 * laws.full
    for name, s, least, most, near in zip(chain.names, travels, low, high, slip, strict=True):
        if not least - near <= s <= most + near:
            raise InputError(
                f"start: {name} at {s * factor:.6g} {unit}: must be between {least * factor:.6g} "
                f"and {most * factor:.6g} {unit}."
            )
    travels = np.where(travels < low + slip, low, travels)
    travels = np.where(travels > high - slip, high, travels)
    return Configuration(tuple(travels.tolist()), tuple(map(int, sheets)))


def starting_state(chain: Chain, problem: DrivenChain, place: Configuration, drive: float) -> State:
    """State of the chain at a place; ValueError where it is no stable equilibrium."""
    alpha, beta, scale = problem.alpha, problem.beta, problem.scale
    travels, full = np.array(place.travel), math.fsum(problem.laws.full.tolist())
    if beta > 0 and 4.0 * EPSILON * alpha * full > _BLUNT * scale * beta:
        _refuse_blunt(chain, scale, full)
    state = st.blank_state(travels, logged.empty_log(0, 0))
    stroke = float(np.sum(travels))
    if beta == 0 and abs(stroke - drive) > 1e-9 * full:
        unit, factor = display_unit(chain.measure.travel_unit)
        raise InputError(
            f"turning_points[0] = {drive * factor:.9g} {unit}: the start has its cells at a "
            f"{chain.measure.stroke} of {stroke * factor:.9g} {unit}; begin there, or pass "
            f"another start."
        )
    balanced, stable, falling, force = stand_at(problem, state, np.array(place.sheet), drive)
    if not balanced:
        raise InputError(_unbalanced(chain, problem, state, force))
    if not stable:
        raise InputError(
            f"start is an unstable equilibrium: {falling} cells between their stops have negative "
            f"stiffness (theory page, 'Stability'). Start from a stable state."
        )
    return state


def _refuse_blunt(chain: Chain, scale: float, full: float) -> None:
    if scale <= cutting.NO_FORCE:
        raise InputError(
            "no cell has any force, so their travels behind a spring are undefined. Tighten a "
            "band, or prescribe the stroke (math.inf, or 'rigid')."
        )
    raise InputError(
        f"actuator_stiffness = {chain.actuator_stiffness:.6g} N/m: is too stiff for cells of "
        f"at most {scale:.3g} N on {full:.3g} m, because the rounding error of its position "
        f"dominates. Prescribe the stroke (math.inf, or 'rigid'), which has the same result."
    )


@entry(3e-5, "state.travel")
@leaf
def stand_at(
    problem: DrivenChain, state: State, sheets: Ints, drive: float
) -> tuple[bool, bool, int, float]:
    """Set all cells to rest; whether they balance, and whether stably."""
    # Also the number of free cells with a falling force, and the force of the actuator.
    laws, pieces, ends = problem.laws, problem.pieces, problem.sheets.ends
    alpha, beta, travel = problem.alpha, problem.beta, state.travel
    cutting.stand_all_on(laws, problem.sheets, pieces, sheets)
    free, pushes, falling, total, size, reach = 0, 0.0, 0, beta, beta, 0.0
    for i in range(len(sheets)):
        st.hold(problem, state, i)
        state.piece[i] = cutting.resting_piece(pieces, i, travel[i])
        reach += abs(travel[i])
        if ends[i, mech.BEFORE] < travel[i] < ends[i, mech.BEYOND] and laws.friction[i] == 0.0:
            state.mode[i] = st.FREE
            free += 1
            pushes += state.at_rest[i]
            falling += int(pieces.sign[state.piece[i]] < 0)
            share = alpha * inverse_slope(problem, i, state.piece[i], travel[i])
            total, size = total + share, size + abs(share)
    low, high = st.held_range(problem, state)
    mean, rounding = pushes / free if free else 0.0, 0.0
    force = mean if free else min(max(0.0, low), high)
    if beta > 0.0:
        # A drive is a double, and behind a stiff spring its last digits are a noticeable force.
        # Within this rounding the cells decide the force.
        force = (drive - alpha * mech.summed(travel)) / beta
        rounding = 4.0 * EPSILON * (abs(drive) + alpha * reach) / beta
    slip = 1e-9 * problem.scale + rounding
    balanced = low <= high + slip and low - slip <= force <= high + slip
    for i in range(len(sheets)):
        balanced = balanced and (state.mode[i] != st.FREE or abs(state.at_rest[i] - force) <= slip)
    shown = mean if free else min(max(force, low), high)
    state.force[0] = min(max(shown, force - rounding), force + rounding)
    # A path may have ended just where it would have snapped: there the sum is rounding.
    stable = falling == 0 or (falling == 1 and total < _FOLD * size)
    return bool(balanced), bool(stable), falling, float(force)


def _unbalanced(chain: Chain, problem: DrivenChain, state: State, force: float) -> str:
    laws, ends, forces = problem.laws, problem.sheets.ends, state.at_rest
    unit, factor = display_unit(chain.measure.travel_unit)
    of_force, size = display_unit(chain.measure.force_unit)
    parts: list[str] = []
    for i, name in enumerate(chain.names):
        rub = laws.friction[i]
        low = forces[i] - rub if state.travel[i] > ends[i, mech.BEFORE] else -math.inf
        high = forces[i] + rub if state.travel[i] < ends[i, mech.BEYOND] else math.inf
        parts.append(
            f"{name} at {state.travel[i] * factor:.6g} {unit} stands for {low * size:.4g}.."
            f"{high * size:.4g} {of_force}"
        )
    given = f" and the actuator gives {force * size:.4g} {of_force}" if problem.beta > 0 else ""
    return (
        f"start is no equilibrium: {'; '.join(parts)}{given}; one force must be within all ranges. "
        f"Start from all cells at 0 and drive to the intended state."
    )
