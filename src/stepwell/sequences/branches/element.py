"""A chain seen from outside: one element, whose sheets are the branches of the chain."""

import math
from dataclasses import replace

import numpy as np

from stepwell.base import Floats
from stepwell.mechanism import Chain, Element, Sheet, through
from stepwell.sequences.branches.branches import Branch, Branches
from stepwell.sequences.branches.checks import refuse_friction
from stepwell.statics import Configuration, SegmentKind, path

# Points on every section of a branch, closer towards its ends, where the force may turn sharply.
_POINTS = 129
# A force that rises at one travel, as where all cells stand at stops, gets so much of the whole
# travel to rise in.
_RAMP = 1e-6


def element_of(chain: Chain, name: str = "") -> Element:
    """A chain as one element. All else as for `Element.from_chain`."""
    refuse_friction(chain)
    branches = Branches(replace(chain, actuator_stiffness=math.inf))
    place = branches.vertex(chain.first_state)
    # In their first phases all cells can hold a force low enough.
    assert place is not None
    numbers = sorted(branches.all_from([branches.at(*place)]))
    own = {number: k for k, number in enumerate(numbers)}
    width = _RAMP * (branches.range[1] - branches.range[0])
    sheets: list[Sheet] = []
    for number in numbers:
        leads = (branches.exit(number, direction) for direction in (-1, +1))
        below, above = (None if one is None else own[one.branch] for one in leads)
        u, force, energy = _curve(branches, number)
        u = _ramped(u, width)
        rows = through(u, force)
        rows[:, 5] += energy
        sheets.append(Sheet.of(rows, float(u[-1]), below, above))
    stopped = all(all(cell.stopped) for cell in chain.cells)
    return Element(tuple(sheets), stopped, name=name, measure=chain.measure)


def _curve(branches: Branches, number: int) -> tuple[Floats, Floats, float]:
    """Strokes and forces along a branch from its lower end up, and the energy where it begins."""
    branch, chain = branches[number], branches.chain
    dense = (1.0 - np.cos(np.linspace(0.0, np.pi, _POINTS))) / 2.0
    grid = np.unique(
        np.concatenate([a + (b - a) * dense for a, b in (s.drive for s in branch.sections)])
    )
    down = _points(chain, branch, [branch.drive, *grid[grid < branch.drive][::-1].tolist()])
    up = _points(chain, branch, [branch.drive, *grid[grid > branch.drive].tolist()])
    u, force = np.array([*reversed(down[0]), *up[0][1:]]).T
    lowest = down[1]
    energy = math.fsum(
        float(cell.energy_at(s, sheet))
        for cell, s, sheet in zip(chain.cells, lowest.travel, lowest.sheet, strict=True)
    )
    return u, force, energy


def _points(
    chain: Chain, branch: Branch, turns: list[float]
) -> tuple[list[tuple[float, float]], Configuration]:
    """(stroke, force) on the way through these strokes, up to a snap, and where it ends."""
    found = path(chain, turns, start=branch.begin)
    points, travels, sheets = [(turns[0], found.start_force)], [*found.start], [*found.start_sheet]
    for segment in found.segments():
        if segment.kind is SegmentKind.SNAP:
            break
        for cell, travel in zip(segment.cells, segment.after, strict=True):
            travels[cell] = travel
        point = segment.drive[1], segment.force[1]
        if point != points[-1]:
            points.append(point)
    return points, Configuration(tuple(travels), tuple(sheets))


def _ramped(u: Floats, width: float) -> Floats:
    """The same strokes, each at least `width` from the one before."""
    out = u.copy()
    for k in range(1, len(out)):
        out[k] = max(out[k], out[k - 1] + width)
    # What that took is given back all along, so that the curve ends where it did.
    return u[0] + (out - u[0]) * ((u[-1] - u[0]) / (out[-1] - u[0]))
