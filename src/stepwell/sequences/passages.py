"""Passages of a path along branches, from snap to snap, and the proof that cells act as relays."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

from stepwell.concave import Relays
from stepwell.mechanism import Chain, Stretch, phase_at
from stepwell.statics import Configuration, Path, Segment, SegmentKind, StaticsError, path


@dataclass(frozen=True, slots=True)
class SmoothRun:
    """A run of equilibria with every cell in the same phase or in transit, from a to b."""

    state: str
    drive: tuple[float, float]
    force: tuple[float, float]
    place: tuple[Configuration, Configuration]

    @property
    def reversed(self) -> "SmoothRun":
        """The same run from b to a."""
        (a, b), (f, g), (s, t) = self.drive, self.force, self.place
        return SmoothRun(self.state, (b, a), (g, f), (t, s))

    def until(self, drive: float, force: float, place: Configuration) -> "SmoothRun":
        """The run with another end."""
        (a, _), (f, _), (s, _) = self.drive, self.force, self.place
        return SmoothRun(self.state, (a, drive), (f, force), (s, place))


@dataclass(frozen=True, slots=True)
class Passage:
    """Sections without a snap between them, and the snap at their end if there is one."""

    sections: tuple[SmoothRun, ...]
    snap: Segment | None


def state_of(stretches: tuple[tuple[Stretch, ...], ...], place: Configuration) -> str:
    """One character a cell: the digit of its phase, or - in transit."""
    own = zip(stretches, place.sheet, place.travel, strict=True)
    return "".join(phase_at(cell, sheet, travel) for cell, sheet, travel in own)


def passages_of(path: Path) -> list[Passage]:
    """The passages of a path between its snaps."""
    stretches = path.chain.stretches
    place = Configuration(path.start, path.start_sheet)

    def resting(drive: float, force: float) -> SmoothRun:
        return SmoothRun(state_of(stretches, place), (drive, drive), (force, force), (place, place))

    passages: list[Passage] = []
    sections = [resting(path.turning_points[0], path.start_force)]
    landed: Segment | None = None
    for segment in path.segments():
        drive, force = segment.drive[1], segment.force[1]
        if segment.kind is SegmentKind.SNAP:
            if landed is None:
                landed = segment
                passages.append(Passage(tuple(sections), landed))
            else:
                # At a fold rounding may give the fold itself again, and then the snap.
                landed = _joined(landed, segment)
                passages[-1] = replace(passages[-1], snap=landed)
            place = _after(place, segment)
            sections = [resting(drive, force)]
            continue
        landed = None
        if segment.kind is SegmentKind.MOVE:
            state = _moving(stretches, place, segment)
            if state != sections[-1].state:
                still = resting(segment.drive[0], segment.force[0])
                sections.append(replace(still, state=state))
            place = _after(place, segment)
        sections[-1] = sections[-1].until(drive, force, place)
        if state_of(stretches, place) != sections[-1].state:
            sections.append(resting(drive, force))
    passages.append(Passage(tuple(sections), None))
    return passages


def _moving(
    stretches: tuple[tuple[Stretch, ...], ...], place: Configuration, segment: Segment
) -> str:
    """The state while cells move: on a segment each is all the way in one phase or in transit."""
    state = list(state_of(stretches, place))
    ways = segment.cells, segment.sheets_before, segment.before, segment.after
    for cell, sheet, a, b in zip(*ways, strict=True):
        if a != b:
            state[cell] = phase_at(stretches[cell], sheet, 0.5 * (a + b))
    return "".join(state)


def _joined(first: Segment, second: Segment) -> Segment:
    """Two snaps at one drive as one."""
    ends = ((s.cells, zip(s.before, s.sheets_before, strict=True)) for s in (second, first))
    before = {cell: end for cells, own in ends for cell, end in zip(cells, own, strict=True)}
    ends = ((s.cells, zip(s.after, s.sheets_after, strict=True)) for s in (first, second))
    after = {cell: end for cells, own in ends for cell, end in zip(cells, own, strict=True)}
    cells = tuple(sorted(before))
    return replace(
        first,
        force=(first.force[0], second.force[1]),
        cells=cells,
        before=tuple(before[cell][0] for cell in cells),
        after=tuple(after[cell][0] for cell in cells),
        sheets_before=tuple(before[cell][1] for cell in cells),
        sheets_after=tuple(after[cell][1] for cell in cells),
        released=first.released + second.released,
        tie=first.tie or second.tie,
    )


def _after(place: Configuration, segment: Segment) -> Configuration:
    travels, sheets = list(place.travel), list(place.sheet)
    for m, cell in enumerate(segment.cells):
        travels[cell], sheets[cell] = segment.after[m], segment.sheets_after[m]
    return Configuration(tuple(travels), tuple(sheets))


class Order(NamedTuple):
    """Properties of relays that hold for a chain under a prescribed stroke, from all cells at 0.

    `leaders_win`: in every snap the cell that triggers it is the one left in transit. Then the
    chain moves as relays do, turn for turn, and only ideals are reached.
    """

    only_ideals: bool
    leaders_win: bool


def order_kept(chain: Chain, fields: Relays) -> Order:
    """Properties of all programs of a chain of equal full travels, proved by its full cycle.

    From any ideal, loading j passes the snaps in which j loads on the full cycle. A turn after one
    of them empties the cell left in transit; full strokes have no such event. So the full cycle
    decides: if that cell may go back without leaving the ideals, only ideals are reached. If not,
    a turn there leaves the ideals. A tie, or a path that cannot be computed, leaves both False.

    Source: ours (theory page, "Stroke programs").
    """
    try:
        cycle = path(chain, [0.0, chain.full_stroke, 0.0])
    except StaticsError:
        return Order(False, False)
    ideals = leaders = not cycle.degenerate
    for passage, landed in pairwise(passages_of(cycle)):
        state = landed.sections[0].state
        if passage.snap is None or state.count("-") != 1:
            return Order(False, False)
        k = state.index("-")
        if passage.snap.direction > 0:
            full = [m for m, at in enumerate(state) if at == "1"]
            ideals &= not any(fields.precedes(k, m) for m in full)
            leaders &= all(fields.down[m] < fields.down[k] for m in full)
        else:
            empty = [m for m, at in enumerate(state) if at == "0"]
            ideals &= not any(fields.precedes(m, k) for m in empty)
            leaders &= all(fields.up[m] > fields.up[k] for m in empty)
    return Order(ideals, leaders)
