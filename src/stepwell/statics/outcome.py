"""Errors and advice for ties and for paths that cannot be computed."""

import math
from collections.abc import Sequence
from typing import NoReturn

import numpy as np

from stepwell.base import Floats, StepwellError, display_unit, join_first, to_unit
from stepwell.mechanism import Cell, Chain, Element
from stepwell.statics.following.certificate import ENERGY, EQUILIBRIUM, STABILITY, STROKE
from stepwell.statics.following.state import GAVE_UP, NOT_SETTLED, RUNS_AWAY, STALLED


class StaticsError(StepwellError, RuntimeError):
    """The path cannot be computed; the text contains place, cause and a possible action."""


_FAILURES = {
    STALLED: (
        "degenerate instability at {place}: {cells} reach their critical forces together. {advice}"
    ),
    NOT_SETTLED: (
        "no landing after the snap at {place}: {cells} approach rest too slowly, because the "
        "energy is almost flat there. {advice}"
    ),
    GAVE_UP: (
        "step limit reached at {place}. Likely causes: nearly equal critical forces of {cells}, or "
        "forces with very many extrema. {advice}"
    ),
    RUNS_AWAY: (
        "the prescribed drive exceeds the range of the chain: all cells are at their end stops at "
        "{place}. Use smaller turning points."
    ),
}


def refuse_failure(
    status: int, chain: Chain, travels: Floats, force: float, involved: Sequence[int]
) -> NoReturn:
    """Raise StaticsError with the advice that belongs to `status` and to the cells involved."""
    measure, (unit, factor) = chain.measure, display_unit(chain.measure.travel_unit)
    pull, by = display_unit(measure.force_unit)
    inside = ", ".join(
        f"{name} {s * factor:.4g} {unit}"
        for name, s in zip(chain.names[:8], travels[:8], strict=True)
    )
    stroke = f"{measure.stroke} {math.fsum(travels) * factor:.6g} {unit}"
    place = f"{stroke}, {force * by:.4g} {pull} ({inside})"
    alike = _with_equal_cells(chain, involved)
    cells, advice = _listed(chain, alike), _advice_to_separate(chain, alike[1:] or alike)
    raise StaticsError(_FAILURES[status].format(place=place, cells=cells, advice=advice))


def _with_equal_cells(chain: Chain, involved: Sequence[int]) -> list[int]:
    ends = [
        np.array([force for phase in own for force in (phase.force_low, phase.force_high)])
        for own in chain.phases
    ]
    return [
        i
        for i, own in enumerate(ends)
        if any(
            i == j or (len(own) == len(ends[j]) and np.allclose(own, ends[j], rtol=1e-6, atol=0.0))
            for j in involved
        )
    ]


def _listed(chain: Chain, cells: Sequence[int], most: int = 4) -> str:
    return join_first([chain.names[i] for i in cells], most)


def _advice_to_separate(chain: Chain, cells: Sequence[int]) -> str:
    """Advice that makes cells differ from each other and from one more like them."""
    if len(cells) == 1:
        return f"{_advice_to_change(chain, cells[0])}, or give it {_friction(chain, cells[0])}."
    elements = [i for i in cells if isinstance(chain.cells[i], Element)]
    levers = [i for i in cells if i not in elements]
    ways = [
        f"{way} of {_listed(chain, own)} by {steps}"
        for own, way, steps in (
            (elements, "scale the forces", "1, 2, … percent"),
            (levers, "move the anchors", "0.1, 0.2, … mm"),
        )
        if own
    ]
    text = " and ".join(ways)
    return f"{text[:1].upper()}{text[1:]}, each by a different step, so that no two are equal."


_BROKEN = {
    EQUILIBRIUM: "the cells are out of balance by {by:.3g} N where forces reach {scale:.3g} N",
    STABILITY: "the equilibrium after a snap is unstable, by {by:.3g} N/m",
    STROKE: "the drive and the travels of the cells differ by {by:.3g} of the drive",
    ENERGY: "energy is out of balance by {mJ:.3g} mJ where forces reach {scale:.3g} N",
}


def refuse_broken(promise: int, chain: Chain, drive: float, by: float, scale: float) -> NoReturn:
    """Raise StaticsError for a computed path that breaks its own certificate at `drive`."""
    what = _BROKEN[promise].format(by=by, mJ=to_unit(by, "mJ"), scale=scale)
    raise StaticsError(
        f"the result at {_drive(chain, drive)} fails its own certificate: {what}. Likely cause: "
        f"numbers too far apart for double precision. Check for a nearly vertical step in a load "
        f"or table, an anchor far outside the mechanism, or forces that cancel to less than a "
        f"millionth."
    )


def advice_on_tie(
    chain: Chain, cells: tuple[int, ...], drive: float, force: float, drifts: bool
) -> str:
    """Description of a tie of one cell's landings or of two cells, with advice."""
    names, where = [chain.names[c] for c in cells], _drive(chain, drive)
    if len(cells) == 1:
        return (
            f"Two landings of the snap of {names[0]} at {where} are closer than the tolerance, so "
            f"friction will decide. {_advice_to_change(chain, cells[0])} and run again."
        )
    other = chain.cells[cells[1]]
    if drifts:
        way = "Give its flat part a slope" if isinstance(other, Element) else "Keep its band taut"
        return (
            f"{names[0]} and {names[1]} have the same constant force up to {where}, so only "
            f"friction decides how they share the motion. {way}, or give {names[1]} "
            f"{_friction(chain, cells[1])}, or pass prefer= to choose which one moves first."
        )
    if not isinstance(other, Element):
        way = (
            f"Move an anchor of {names[1]} by more than "
            f"{to_unit(_anchor_step(other, force), 'mm'):.2g} mm to set them one percent of its "
            "peak force apart"
        )
    elif abs(force) > 0.01 * other.largest_force:
        way = f"Scale the forces of {names[1]} by more than one percent"
    else:
        # No scale changes a force of zero.
        way = f"Give {names[1]} {_friction(chain, cells[1])}"
    return (
        f"{names[0]} and {names[1]} tie at {where}, so friction will decide; {names[0]} was taken "
        f"first. {way}, or pass prefer= to choose which one moves first."
    )


def _drive(chain: Chain, drive: float) -> str:
    unit, factor = display_unit(chain.drive_unit)
    return f"drive {drive * factor:.6g} {unit}"


def _advice_to_change(chain: Chain, index: int) -> str:
    if isinstance(chain.cells[index], Element):
        return f"Scale the forces of {chain.names[index]} by a percent or more"
    return f"Move an anchor of {chain.names[index]} by 0.1 mm or more"


def _friction(chain: Chain, index: int) -> str:
    """Friction that separates the forces of a cell by one percent of the largest."""
    pull, by = display_unit(chain.measure.force_unit)
    return f"a friction of {0.01 * chain.cells[index].largest_force * by:.2g} {pull}"


def _anchor_step(cell: Cell, force: float) -> float:
    """Anchor displacement along x [m] that changes a critical force by 1 % of the cell's peak."""
    step, ends = 1e-5, np.array([cell.force_0, cell.force_1])
    dx, dy = cell.bands[0].q
    moved = cell.with_anchors(q=(dx + step, dy)) if len(cell.bands) == 1 else cell
    changes = np.abs(np.array([moved.force_0, moved.force_1]) - ends)
    slope = float(changes[np.argmin(np.abs(ends - force))]) / step
    peak = float(np.max(np.abs(ends)))
    return 0.01 * peak / slope if slope > 0 else 1e-4
