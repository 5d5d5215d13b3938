"""What to measure before the first pull, with expected values, tolerances, and their meaning."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from stepwell.base import GRAVITY, percent
from stepwell.build.contour import GRAMS, MM
from stepwell.build.layouts import Layout
from stepwell.build.seats import CellPlan
from stepwell.build.tolerances import stop_error
from stepwell.design import Yield, measurement
from stepwell.mechanism import Band, Cell

# Step of the slopes of a force: a fraction of stiffness and rest length, and a length [m].
_STEP = 1e-4
_LENGTH = 1e-6


class Expected(NamedTuple):
    """One measurement on an assembled mechanism.

    Attributes:
        what: what is measured, and how.
        value, tolerance: as text with its unit.
        meaning: the likely cause of a deviation, and an action.
    """

    what: str
    value: str
    tolerance: str
    meaning: str


_PARTS = {
    "d": "distance of the anchors of the bands",
    "stiffness": "stiffness of the bands",
    "rest_length": "free length of the bands",
    "lever": "length of the levers",
    "friction": "friction",
}


def first_measurement(counted: Yield | None) -> str:
    """The measurement that raises the yield of a build most, as a sentence; "" for none."""
    one = None if counted is None else measurement(counted)
    if one is None:
        return ""
    return (
        f"Measure first the {_PARTS[one.what]} of cell {one.cell + 1}: if it is known to a tenth "
        f"of a millimetre or 2 %, {percent(one.after)} instead of {percent(one.before)} of builds "
        f"keep the sequence."
    )


def expected(layout: Layout, sequence: str | None) -> list[Expected]:
    """What to measure, from the parts to the motion.

    Args:
        layout: of the build.
        sequence: such as "00>10>11>01>00"; None if the design has none.
    """
    rows: list[Expected] = []
    for plan in layout.cells:
        rows += _of_cell(plan, layout)
    if sequence:
        meaning = (
            "Another order: compare the forces above. The cell that switches too early has the "
            "weaker band or the wrong hole."
        )
        what = "States of the cells, inner first, while the drive is pulled out and let back slowly"
        rows.append(Expected(what, sequence.replace(">", " > "), "exact", meaning))
    return rows


def _of_cell(plan: CellPlan, layout: Layout) -> Iterator[Expected]:
    cell, name, errors = plan.cell, f"cell {plan.number + 1}", layout.build_file.tolerance
    # Both ends may be off, one in either direction.
    travel = math.sqrt(2.0) * cell.lever * math.cos(cell.limit) * stop_error(plan, layout)
    where = "the ends of the arc slot" if plan.slotted else "the faces"
    yield Expected(
        f"Travel of {name} from stop to stop, along the stroke, bands off",
        _mm(cell.full_travel),
        f"±\u00a0{_mm(travel)}",
        f"Longer: {where} were cut away; enter the kerf and cut again. Shorter: burrs on them.",
    )
    for number, band in enumerate(cell.bands):
        label = f"band {number + 1} of {name}"
        yield Expected(
            f"Length of {label} when it is just not slack",
            _mm(band.rest_length),
            f"±\u00a0{_mm(errors.rest_length * band.rest_length)}",
            "Choose another band of the pack, or design with the measured length.",
        )
        for state, theta in (("0", -cell.limit), ("1", cell.limit)):
            yield _of_hooks(cell, band, (label, state, theta), layout)
    yield from _forces(plan, layout)


def _of_hooks(cell: Cell, band: Band, about: tuple[str, str, float], layout: Layout) -> Expected:
    label, state, theta = about
    errors = layout.build_file.tolerance
    length = float(band.length(np.array([theta]), cell.lever)[0])
    force = float(band.tension(np.array([length]))[0])
    # Two holes, and the stop across the band at most.
    apart = math.hypot(math.sqrt(2.0) * errors.hole, errors.stop)
    grams = GRAMS * force / GRAVITY
    pull = f"{force:.2f}\u00a0N =\u00a0{grams:.0f}\u00a0g" if force > 0.0 else "slack"
    return Expected(
        f"Hook centre to hook centre of {label} in state {state}; pull of the band there",
        f"{_mm(length)}; {pull}",
        f"±\u00a0{_mm(apart)}; ±\u00a0{100.0 * errors.stiffness:.0f}\u00a0%",
        "Length off by a whole pitch: a hook is in the wrong hole. Pull off: another band.",
    )


def _forces(plan: CellPlan, layout: Layout) -> Iterator[Expected]:
    """The forces at which a cell leaves its states, at the drive, all other cells held."""
    cell = plan.cell
    ends: tuple[tuple[str, Callable[[Cell], float]], ...] = (
        ("0", lambda one: one.force_0),
        ("1", lambda one: one.force_1),
    )
    for state, of in ends:
        value = of(cell)
        spread = _spread(cell, of, layout)
        way = "pull" if value >= 0.0 else "push"
        yield Expected(
            f"Force at which cell {plan.number + 1} leaves state {state}, the other cells held",
            f"{way}\u00a0{abs(value):.2f}\u00a0N =\u00a0{GRAMS * abs(value) / GRAVITY:.0f}\u00a0g",
            f"±\u00a0{spread:.2f}\u00a0N",
            "Too large: a joint rubs or the band is stiff. Too small: wrong hole or weak band.",
        )


def _spread(cell: Cell, of: Callable[[Cell], float], layout: Layout) -> float:
    """Tolerance of a force [N]: errors of bands and holes, added as independent errors."""
    errors, total = layout.build_file.tolerance, 0.0
    here = of(cell)
    for number, band in enumerate(cell.bands):
        (px, py), step, more = band.p, _LENGTH, 1.0 + _STEP
        changed = (
            (replace(band, stiffness=band.stiffness * more), errors.stiffness / _STEP),
            (replace(band, rest_length=band.rest_length * more), errors.rest_length / _STEP),
            (replace(band, p=(px + step, py)), math.sqrt(2.0) * errors.hole / step),
            (replace(band, p=(px, py + step)), math.sqrt(2.0) * errors.hole / step),
        )
        for other, scale in changed:
            bands = (*cell.bands[:number], other, *cell.bands[number + 1 :])
            total += ((of(replace(cell, band=bands)) - here) * scale) ** 2
    return math.sqrt(total)


def _mm(value: float) -> str:
    return f"{MM * value:.2f}\u00a0mm"
