"""The rate up to which a chain with masses keeps the order of its quasi-static path."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, Measure, amount
from stepwell.concave import SortedChain
from stepwell.kernels import UNLIMITED
from stepwell.mechanism import FIRST, law, phase_at
from stepwell.statics.events import Segment, SegmentKind
from stepwell.statics.following import log as logged
from stepwell.statics.following.state import DrivenChain
from stepwell.statics.landings.proofs import energy_holds
from stepwell.statics.landings.start import Snap
from stepwell.statics.outcome import StaticsError

if TYPE_CHECKING:
    from stepwell.statics.path import Path

# Mass of a block where none is given: of cells cut from 3 mm acrylic 9 to 17 g.
BLOCK = 0.010
# Cells of the longest chain that is integrated where no proof covers its snaps.
_MOST_INTEGRATED = 6
# Fractions of the balance of forces that are tried then, each with a tenth of it.
_SHARES = 1.0, 0.25


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SafeRate(ByValue):
    """Rate up to which a chain with masses keeps the order of its quasi-static path; N cells.

    Attributes:
        rate: cycles per second of a crank [Hz]; infinite where it does not matter, None where no
            rate is known to be safe.
        reason: why; empty where there is a finite rate.
        masses: (N,) of the block outside each cell [kg].
        damping: (N,) on the travels [N s/m].
        gap: least difference of the force at which a cell sets off to that of a competitor [N].
        stiffness: largest slope of a force in size [N/m].
        proved: whether energy alone proves the landings of all snaps; if not, motions at the rate
            and at a tenth of it were integrated.

    Source: theory page, "Rate".
    """

    rate: float | None
    reason: str
    masses: tuple[float, ...]
    damping: tuple[float, ...]
    gap: float
    stiffness: float
    proved: bool

    def __str__(self):
        if self.rate is None:
            return f"none known: {self.reason}"
        if math.isinf(self.rate):
            return f"any: {self.reason}"
        return f"{amount(self.rate, 'Hz', 3)} with blocks of {amount(max(self.masses), 'kg', 3)}"

    def __repr__(self):
        return f"SafeRate({self})"


class Inside(NamedTuple):
    """What a path has computed."""

    problem: DrivenChain
    log: logged.Log
    snaps: Callable[[], Iterator[Snap]]


def safe_rate(
    path: Path,
    inside: Inside,
    masses: Iterable[float] | None = None,
    damping: Iterable[float] | None = None,
    *,
    integrate: bool = True,
) -> SafeRate:
    """The safe rate of a path, as for `Path.safe_rate`."""
    chain, problem = path.chain, inside.problem
    n, gap, slope = len(chain), force_gap(path, inside.log), largest_slope(problem)
    mass = tuple([BLOCK] * n if masses is None else map(float, masses))
    damper = tuple([0.0] * n if damping is None else map(float, damping))

    def result(rate: float | None, reason: str, proved: bool = False) -> SafeRate:
        return SafeRate(rate, reason, mass, damper, gap, slope, proved)

    if undefined := _why_undefined(path, inside, gap, usual=masses is None):
        return result(None, undefined)
    rate = _balance(path, (mass, damper), gap, slope)
    if math.isinf(rate):
        return result(rate, "the only cell moves with the actuator", True)
    forces = SortedChain.of(chain) if problem.beta == 0.0 else None
    if forces is not None and proved_by_energy(path, inside):
        return result(rate, "", True)
    if not integrate:
        return result(None, "no proof covers its snaps, safe_rate() of its path integrates them")
    if n > _MOST_INTEGRATED:
        return result(None, f"{n} cells whose snaps no proof covers: too many to integrate")
    if chain.elements and not any(damper):
        return result(None, "its elements ring after a snap: give damping")
    for share in _SHARES:
        if all(_keeps(path, rate * share * one, mass, damper) for one in (1.0, 0.1)):
            return result(rate * share, "")
    return result(None, "with these masses a snap lands elsewhere at any rate")


def _keeps(path: Path, rate: float, mass: tuple[float, ...], damper: tuple[float, ...]) -> bool:
    try:
        return path.at_rate(rate, mass, damper).keeps_order
    except StaticsError:
        return False


def _balance(
    path: Path, inertia: tuple[tuple[float, ...], tuple[float, ...]], gap: float, slope: float
) -> float:
    """The rate f with V (√(M κ) + c) + M A = gap, V = π f U and A = 2 π² f² U."""
    (mass, damper), turns = inertia, path.turning_points
    rigid = math.isinf(path.chain.actuator_stiffness)
    moved, way = sum(mass[:-1] if rigid else mass), max(turns) - min(turns)
    stiff = slope if rigid else max(slope, path.chain.actuator_stiffness)
    square = 2.0 * math.pi**2 * way * moved
    linear = math.pi * way * (math.sqrt(moved * stiff) + max(damper))
    if not math.isfinite(gap):
        return math.inf
    root = math.sqrt(linear * linear + 4.0 * square * gap)
    return 2.0 * gap / (linear + root) if linear + root > 0.0 else math.inf


def largest_slope(problem: DrivenChain) -> float:
    """The largest |dF/ds| of any cell [N/m]."""
    # The slope of a piece is monotone, so it is largest at an end.
    pieces, table = problem.pieces, problem.sheets.table
    # Not by np.unique, whose import of np.ma takes longer than all else here.
    first = sorted({*table[:, FIRST].tolist()})
    most = 0.0
    for sheet in range(len(table)):
        cell = first.index(float(table[sheet, FIRST]))
        for p in range(int(pieces.of_sheet[sheet]), int(pieces.of_sheet[sheet + 1])):
            rows = pieces.picked[p].copy()
            for travel in (float(pieces.left[p]), float(pieces.right[p])):
                if math.isfinite(travel):
                    most = max(most, abs(law(problem.laws, cell, rows, travel)[1]))
    return most


def force_gap(path: Path, log: logged.Log) -> float:
    """Least distance of λ to the critical force of a competitor where a cell sets off [N]."""
    return min(_gaps(path, log), default=math.inf)


def _why_undefined(path: Path, inside: Inside, gap: float, *, usual: bool) -> str:
    """Why a path with this smallest gap of forces [N] has no safe rate for the masses; or ""."""
    measure = path.chain.measure
    if usual and measure is not Measure.TRAVEL:
        return f"no {measure.travel} has a usual mass: give masses"
    if inside.problem.alpha == 0.0:
        return "under a prescribed force the masses decide how long a snap lasts"
    if path.degenerate or not gap > 0.0:
        return "a tie: the order is undecided even without masses"
    return ""


def _setting_off(one: Segment, then: Segment, row: Floats) -> tuple[set[int], set[int]]:
    """Cells that moved before a segment and go on, and cells that set off in it; see `logged`."""
    goes_on = one.kind is SegmentKind.MOVE and one.direction == then.direction
    moved = {*one.cells} if goes_on else set[int]()
    if then.kind is SegmentKind.SNAP:
        return moved, {int(row[logged.LEADER])}
    ends = then.kind is SegmentKind.HOLD or one.kind is SegmentKind.SNAP
    return moved, set() if ends else {*then.cells} - moved


def _gaps(path: Path, log: logged.Log) -> Iterator[float]:
    chain, rows = path.chain, log.segments
    stretches, phases = chain.stretches, [cell.phases for cell in chain.cells]
    travel, sheet = list(path.start), list(path.start_sheet)
    segments = list(path.segments())
    for k, (one, then) in enumerate(pairwise(segments), 1):
        for cell, s, on in zip(one.cells, one.after, one.sheets_after, strict=True):
            travel[cell], sheet[cell] = s, on
        moved, off = _setting_off(one, then, rows[k])
        if not off:
            continue
        for i in range(len(chain)):
            digit = phase_at(stretches[i], sheet[i], travel[i])
            if i in off or digit == "-":
                continue
            phase, rub = phases[i][int(digit)], chain.cells[i].friction
            if i in moved and phase.low == phase.high:
                # It has just arrived at this stop.
                continue
            yield min(phase.force_high + rub - one.force[1], one.force[1] - phase.force_low + rub)


def proved_by_energy(path: Path, inside: Inside) -> bool:
    """Whether energy alone proves the landing of every snap of concave cells, for all masses."""
    if len(path.chain) == 2:
        # Of a pair one block is free, and its snap ends at a stop.
        return True
    for snap in inside.snaps():
        fresh = inside.problem._replace(effort=np.array([0, UNLIMITED]))
        same = np.array_equal(snap.sheet, snap.start.sheet)
        if not (same and energy_holds(fresh, snap.start, snap.travel)):
            return False
    return True
