"""The errors of a build as the tolerances of a yield, and the yield of the parts as cut."""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from stepwell.base import Floats, Progress
from stepwell.build.layouts import Layout
from stepwell.build.seats import CellPlan
from stepwell.design import Tolerances, Yield, yields
from stepwell.mechanism import Cell

# Step of central differences, as a fraction of the lever: F has no kink at an end of the travel
# unless a band is slack there, and then the larger slope counts.
_STEP = 1e-6


def lever_error(layout: Layout) -> float:
    """Error of a lever between its joints [m]: two holes, and the slop of both joints.

    A pin may lie anywhere in its hole: the joints of a lever are nearer or farther by up to the
    slop, half of it at either end.
    """
    errors = layout.build_file.tolerance
    return math.hypot(errors.hole * math.sqrt(2.0), errors.joint)


def stop_error(plan: CellPlan, layout: Layout) -> float:
    """Error of θc [rad] by faces or by an arc slot.

    Faces that are off by e across the stroke stop the cell at an angle off by e / (r sin θc), a
    travel error of e cot θc. A slot that is off by e along its arc: e / r, a travel error of
    e cos θc. A lever that is off by e moves faces by e cos θc, and a slot not at all.
    """
    errors, cell = layout.build_file.tolerance, plan.cell
    if plan.slotted:
        return errors.stop / cell.lever
    across = (errors.stop, errors.kerf, lever_error(layout) * math.cos(cell.limit))
    return math.hypot(*across) / (cell.lever * math.sin(cell.limit))


def anchor_of_stop(plan: CellPlan, layout: Layout) -> float:
    """The displacement of an anchor [m] that changes F0 or F1 as much as the stop's error does.

    `Tolerances` has no error of θc; this is the radius of an anchor's error in its place, of the
    end for which it is larger.
    """
    cell, error = plan.cell, stop_error(plan, layout)
    return max(
        abs(by_angle) * error / by_anchor if by_anchor > 0.0 else 0.0
        for by_angle, by_anchor in (_slopes(cell, end) for end in (-cell.limit, cell.limit))
    )


def _slopes(cell: Cell, theta: float) -> tuple[float, float]:
    """|dF/dθ| [N/rad] and the steepest |dF/dd| [N/m] of a cell's bands at an angle."""

    def force(angle: float, x: float = 0.0, y: float = 0.0) -> float:
        moved = (replace(one, q=(one.q[0] + x, one.q[1] + y)) for one in cell.bands)
        return sum(float(one.force(angle, cell.lever)) for one in moved)

    step = _STEP * cell.lever
    here = force(theta)
    by_angle = max(abs(force(theta + way * _STEP) - here) / _STEP for way in (-1.0, 1.0))
    gradient: Floats = np.array(
        [
            max(abs(force(theta, *(way * step * axis)) - here) / step for way in (-1.0, 1.0))
            for axis in np.eye(2)
        ]
    )
    return by_angle, float(np.hypot(*gradient))


def tolerances_of(layout: Layout) -> Tolerances:
    """The tolerances of a layout for `Chain.yields`.

    Holes and stops are one error of the anchors, holes and joints one of the levers; bands are
    those of the build file.
    """
    errors = layout.build_file.tolerance
    stops = max(anchor_of_stop(plan, layout) for plan in layout.cells)
    return Tolerances(
        anchor=math.hypot(errors.hole, stops),
        stiffness=errors.stiffness,
        rest_length=errors.rest_length,
        lever=lever_error(layout),
    )


def build_yield(
    layout: Layout,
    *,
    samples: int | None = None,
    target: str | Iterable[str] | None = None,
    progress: Progress = None,
) -> Yield:
    """The yield of the design with the errors of its build file; arguments as `Chain.yields`."""
    return yields(
        layout.chain, tolerances_of(layout), samples=samples, target=target, progress=progress
    )
