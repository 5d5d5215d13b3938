"""What to tell the user when the model ties or the follower cannot go on."""

import math
from typing import NoReturn

from stepwell.base import Floats, StepwellError, told_in
from stepwell.mechanism import Cell, Chain, Element
from stepwell.statics.following import (
    ENERGY,
    EQUILIBRIUM,
    GAVE_UP,
    NOT_SETTLED,
    RUNS_AWAY,
    STABILITY,
    STALLED,
    STROKE,
)


class StaticsError(StepwellError, RuntimeError):
    """The follower could not go on; the text says where, why and what to do."""


_FAILURES = {
    STALLED: (
        "two events keep undoing each other at {place}: two cells balance to the last digit. Move "
        "an anchor by 0.01 mm, or give the cells a little friction."
    ),
    NOT_SETTLED: (
        "after a snap at {place} the cells come to rest too slowly to say where: the landing is "
        "almost flat. Move an anchor by 0.1 mm or give the cells a little friction."
    ),
    GAVE_UP: (
        "at {place} the run was given up after as many looks as take some seconds: forces that are "
        "alike to the last digits, or that turn very often. Move an anchor by 0.01 mm, or smooth "
        "the tables."
    ),
    RUNS_AWAY: (
        "at {place} all cells stand at their stops and the drive goes on: turn back earlier."
    ),
}


def refuse_failure(status: int, chain: Chain, travels: Floats, force: float) -> NoReturn:
    """Raise StaticsError with the advice that belongs to `status`."""
    measure, (unit, factor) = chain.measure, told_in(chain.measure.travel_unit)
    pull, by = told_in(measure.force_unit)
    inside = ", ".join(
        f"{name} {s * factor:.4g} {unit}"
        for name, s in zip(chain.names[:8], travels[:8], strict=True)
    )
    stroke = f"{measure.stroke} {math.fsum(travels) * factor:.6g} {unit}"
    place = f"{stroke}, {force * by:.4g} {pull} ({inside})"
    raise StaticsError(_FAILURES[status].format(place=place))


_BROKEN = {
    EQUILIBRIUM: "the cells are out of balance by {by:.3g} N where forces reach {scale:.3g} N",
    STABILITY: "the place where a snap lands is unstable, by {by:.3g} N/m",
    STROKE: "the travels of the cells and the drive differ by {by:.3g} of it",
    ENERGY: "energy is out of balance by {mJ:.3g} mJ where forces reach {scale:.3g} N",
}


def refuse_broken(promise: int, chain: Chain, drive: float, by: float, scale: float) -> NoReturn:
    """Raise StaticsError for a computed path that breaks its own certificate at `drive`."""
    what = _BROKEN[promise].format(by=by, mJ=by * 1e3, scale=scale)
    raise StaticsError(
        f"no answer: at {_drive(chain, drive)} {what}, so the result would break its own "
        f"certificate. Its numbers are too far apart for double precision: look for a step in a "
        f"load or table that is all but vertical, an anchor far outside the mechanism, or forces "
        f"that cancel to less than a millionth of themselves."
    )


def advice_on_tie(chain: Chain, cells: tuple[int, ...], drive: float, drifts: bool) -> str:
    """What happens at a tie and what the user can do about it.

    Args:
        chain: the chain.
        cells: the cells that tie, or the one whose landing does.
        drive: where [m], or [N] under force control.
        drifts: whether the cells drift together, at the same constant force.
    """
    names, where = [chain.names[c] for c in cells], _drive(chain, drive)
    if len(cells) == 1:
        return (
            f"Two landings of the snap of {names[0]} at {where} are closer than the tolerance, so "
            f"friction will decide. {_nudge(chain, cells[0])} and look again."
        )
    if drifts:
        return (
            f"{names[0]} and {names[1]} offer the same constant force up to {where}, so only "
            f"friction tells how they share the motion. Keep a band taut, give one of them "
            f"friction, or pass prefer= to say which one goes first."
        )
    other = chain.cells[cells[1]]
    way = (
        f"Scale the forces of {names[1]} by more than one percent"
        if isinstance(other, Element)
        else f"Move an anchor of {names[1]} by more than {_anchor_step(other) * 1e3:.2g} mm to set "
        f"them one percent of its peak force apart"
    )
    return (
        f"{names[0]} and {names[1]} tie at {where}, so friction will decide; {names[0]} was taken "
        f"first. {way}, or pass prefer= to say which one you mean."
    )


def _drive(chain: Chain, drive: float) -> str:
    unit, factor = told_in(chain.drive_unit)
    return f"drive {drive * factor:.6g} {unit}"


def _nudge(chain: Chain, index: int) -> str:
    """What sets two outcomes of a cell apart."""
    if isinstance(chain.cells[index], Element):
        return f"Scale the forces of {chain.names[index]} by a percent or more"
    return f"Move an anchor of {chain.names[index]} by 0.1 mm or more"


def _anchor_step(cell: Cell) -> float:
    """Anchor move along x [m] that changes F0 by one percent of the cell's peak force."""
    step = 1e-5
    dx, dy = cell.bands[0].q
    moved = cell.with_anchors(q=(dx + step, dy)) if len(cell.bands) == 1 else cell
    slope = abs(moved.force_0 - cell.force_0) / step
    peak = max(abs(cell.force_0), abs(cell.force_1))
    return 0.01 * peak / slope if slope > 0 else 1e-4
