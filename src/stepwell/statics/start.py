"""Reading where a path starts, and refusing a start that could not stand there."""

import math
from collections.abc import Sequence

import numpy as np

from stepwell.base import Floats, InputError, Ints, told_in
from stepwell.kernels import entry
from stepwell.mechanism import BEFORE, BEYOND, FIRST, HIGH, LOW, Cell, Chain
from stepwell.statics.following import (
    FREE,
    NO_FORCE,
    Problem,
    State,
    blank_state,
    held_range,
    hold,
    inverse_slope,
    log as logged,
    resting_piece,
    stand_all_on,
)
from stepwell.statics.places import Configuration, place_at

EPSILON = float(np.finfo(float).eps)
# A spring whose force is known to no better than this share of the cells' tells nothing.
_BLUNT = 1e-2
# A sum of compliances below this share of them is that of a fold.
_FOLD = 1e-5


def starting_configuration(
    chain: Chain,
    problem: Problem,
    start: str | Configuration | Sequence[float] | None,
    drive: float,
) -> Configuration:
    """Where a start is, given as a state such as "010", as a place, as travels, or not at all.

    Travels alone are on the first sheets of the curves.

    Raises:
        ValueError: a state that the chain does not have or in which it does not stand at `drive`,
            a travel past a stop, or past the end of its sheet.
    """
    if start is None or isinstance(start, str):
        return place_at(chain, problem, chain.first_state if start is None else start, drive)
    given, sheets = start if isinstance(start, Configuration) else (start, (0,) * len(chain))
    travels = np.asarray(given, float)
    if travels.shape != (len(chain),):
        raise InputError(f"start has shape {travels.shape}: must be ({len(chain)},) travels [m].")
    laws, (unit, factor) = problem.laws, told_in(chain.measure.travel_unit)
    counts = [1 if isinstance(cell, Cell) else len(cell.sheets) for cell in chain.cells]
    if len(sheets) != len(chain) or any(
        not 0 <= k < n for k, n in zip(sheets, counts, strict=True)
    ):
        raise InputError(
            f"start.sheet = {sheets!r}: must name one sheet a cell, counted from 0, of as many as "
            f"its curve has: {', '.join(map(str, counts))}."
        )
    table, now = problem.sheets.table, problem.sheets.now
    low, high = table[table[now, FIRST].astype(int) + np.array(sheets), LOW : HIGH + 1].T
    slip = 1e-9 * laws.full
    ends = zip(chain.names, travels, low, high, slip, strict=True)
    for name, s, least, most, near in ends:
        if not least - near <= s <= most + near:
            raise InputError(
                f"start: {name} at {s * factor:.6g} {unit}: must be between {least * factor:.6g} "
                f"and {most * factor:.6g} {unit}."
            )
    travels = np.where(travels < low + slip, low, travels)
    travels = np.where(travels > high - slip, high, travels)
    return Configuration(tuple(travels.tolist()), tuple(map(int, sheets)))


def starting_state(chain: Chain, problem: Problem, place: Configuration, drive: float) -> State:
    """The state in which the chain stands at a place while the actuator is at `drive`.

    Raises:
        ValueError: the drive does not fit the travels, or the cells do not balance, or they
            balance in an unstable way, or the actuator is too stiff for a double to tell.
    """
    alpha, beta, scale = problem.alpha, problem.beta, problem.scale
    travels, full = np.array(place.travel), math.fsum(problem.laws.full.tolist())
    if beta > 0 and 4.0 * EPSILON * alpha * full > _BLUNT * scale * beta:
        if scale <= NO_FORCE:
            raise InputError(
                "no cell has any force, so nothing tells where they stand behind a spring: tighten "
                "a band, or prescribe the stroke (math.inf, or 'rigid')."
            )
        raise InputError(
            f"actuator_stiffness = {chain.actuator_stiffness:.6g} N/m: is too stiff for cells of "
            f"at most {scale:.3g} N on {full:.3g} m: the last digit of its position "
            f"would decide. Prescribe the stroke (math.inf, or 'rigid'), which does the same."
        )
    state = blank_state(travels, logged.empty_log(0, 0))
    low, high, falling, total, size = _rest(problem, state, np.array(place.sheet))
    forces, free = state.at_rest, state.mode == FREE
    stroke = float(np.sum(travels))
    if beta == 0:
        if abs(stroke - drive) > 1e-9 * full:
            unit, factor = told_in(chain.measure.travel_unit)
            raise InputError(
                f"turning_points[0] = {drive * factor:.9g} {unit}: the start has its cells at a "
                f"{chain.measure.stroke} of {stroke * factor:.9g} {unit}; begin there, or pass "
                f"another start."
            )
        force = float(np.mean(forces[free])) if free.any() else min(max(0.0, low), high)
    else:
        force = (drive - alpha * stroke) / beta
    # A drive is a double, and behind a stiff spring its last digits are a force to be seen. What
    # it leaves open the cells tell.
    reach = abs(drive) + alpha * float(np.sum(np.abs(travels)))
    rounding = 4.0 * EPSILON * reach / beta if beta > 0 else 0.0
    slip = 1e-9 * scale + rounding
    worst = float(np.max(np.abs(forces[free] - force))) if free.any() else 0.0
    if worst > slip or low > high + slip or not low - slip <= force <= high + slip:
        raise InputError(_unbalanced(chain, problem, state, forces, force))
    # A path may have ended just where it would have snapped: there the sum is rounding.
    if falling > 1 or (falling == 1 and total >= _FOLD * size):
        raise InputError(
            f"start is an unstable equilibrium: {falling} cells between their stops push back less "
            f"the further they go (theory page, 'Stability'); the chain would leave it by itself."
        )
    shown = float(np.mean(forces[free])) if free.any() else min(max(force, low), high)
    state.force[0] = min(max(shown, force - rounding), force + rounding)
    return state


@entry(3e-5, "state.travel")
def _rest(problem: Problem, state: State, sheets: Ints) -> tuple[float, float, int, float, float]:
    """Let every cell rest where it is, on its sheet, free where nothing holds it.

    Returns:
        The forces at which every held cell stays; how many of the free ones have a falling force;
        their compliance dU/dλ, and the sum of the sizes of its terms.
    """
    laws, pieces, ends = problem.laws, problem.pieces, problem.sheets.ends
    stand_all_on(laws, problem.sheets, pieces, sheets)
    falling, total, size = 0, problem.beta, problem.beta
    for i in range(len(sheets)):
        travel = state.travel[i]
        hold(problem, state, i)
        state.piece[i] = resting_piece(pieces, i, travel)
        if ends[i, BEFORE] < travel < ends[i, BEYOND] and laws.friction[i] == 0.0:
            state.mode[i] = FREE
            falling += int(pieces.sign[state.piece[i]] < 0)
            share = problem.alpha * inverse_slope(laws, pieces, i, state.piece[i], travel)
            total, size = total + share, size + abs(share)
    low, high = held_range(problem, state)
    return low, high, falling, total, size


def _unbalanced(chain: Chain, problem: Problem, state: State, forces: Floats, force: float) -> str:
    laws, ends = problem.laws, problem.sheets.ends
    unit, factor = told_in(chain.measure.travel_unit)
    of_force, size = told_in(chain.measure.force_unit)
    parts: list[str] = []
    for i, name in enumerate(chain.names):
        rub = laws.friction[i]
        low = forces[i] - rub if state.travel[i] > ends[i, BEFORE] else -math.inf
        high = forces[i] + rub if state.travel[i] < ends[i, BEYOND] else math.inf
        parts.append(
            f"{name} at {state.travel[i] * factor:.6g} {unit} stands for {low * size:.4g}.."
            f"{high * size:.4g} {of_force}"
        )
    given = f" and the actuator gives {force * size:.4g} {of_force}" if problem.beta > 0 else ""
    return (
        f"start is no equilibrium: {'; '.join(parts)}{given}; one force must suit all. Start from "
        f"all cells at 0 and drive to the state that you mean."
    )
