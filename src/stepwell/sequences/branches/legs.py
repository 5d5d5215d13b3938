"""Smooth parts of a path, cut where the chain snaps or another set of cells moves."""

from dataclasses import dataclass, replace

from stepwell.statics import Path, Segment, SegmentKind


@dataclass(frozen=True, slots=True)
class Part:
    """A run of equilibria with the same cells at 0, at 1 and in transit, from a to b."""

    state: str
    drive: tuple[float, float]
    force: tuple[float, float]
    travel: tuple[tuple[float, ...], tuple[float, ...]]

    @property
    def reversed(self) -> "Part":
        """The same run from b to a."""
        (a, b), (f, g), (s, t) = self.drive, self.force, self.travel
        return Part(self.state, (b, a), (g, f), (t, s))

    def until(self, drive: float, force: float, travel: tuple[float, ...]) -> "Part":
        """The run with another end."""
        return replace(
            self,
            drive=(self.drive[0], drive),
            force=(self.force[0], force),
            travel=(self.travel[0], travel),
        )


@dataclass(frozen=True, slots=True)
class Leg:
    """Parts that follow each other smoothly, and the snap that ends them if one does."""

    parts: tuple[Part, ...]
    snap: Segment | None


def state_of(travels: tuple[float, ...], full: tuple[float, ...]) -> str:
    """One character a cell: 0, 1, or - between the stops."""
    return "".join(
        "0" if s == 0 else "1" if s == f else "-" for s, f in zip(travels, full, strict=True)
    )


def legs_of(path: Path) -> list[Leg]:
    """The smooth parts of a path between its snaps."""
    full = tuple(cell.full_travel for cell in path.chain.cells)
    travels = path.start
    legs: list[Leg] = []

    def resting(drive: float, force: float) -> Part:
        return Part(state_of(travels, full), (drive, drive), (force, force), (travels, travels))

    parts = [resting(path.turning_points[0], path.start_force)]
    landed: Segment | None = None
    for segment in path.segments():
        drive, force = segment.drive[1], segment.force[1]
        if segment.kind is SegmentKind.SNAP:
            if landed is None:
                landed = segment
                legs.append(Leg(tuple(parts), landed))
            else:
                # At a fold rounding may find the fold itself again, and then the way on.
                landed = _joined(landed, segment)
                legs[-1] = replace(legs[-1], snap=landed)
            travels = _after(travels, segment)
            parts = [resting(drive, force)]
            continue
        landed = None
        if segment.kind is SegmentKind.MOVE:
            moving = list(state_of(travels, full))
            for cell, a, b in zip(segment.cells, segment.before, segment.after, strict=True):
                if a != b:
                    moving[cell] = "-"
            state = "".join(moving)
            if state != parts[-1].state:
                at, pull = segment.drive[0], segment.force[0]
                parts.append(Part(state, (at, at), (pull, pull), (travels, travels)))
            travels = _after(travels, segment)
        parts[-1] = parts[-1].until(drive, force, travels)
        if state_of(travels, full) != parts[-1].state:
            parts.append(resting(drive, force))
    legs.append(Leg(tuple(parts), None))
    return legs


def _joined(first: Segment, second: Segment) -> Segment:
    """Two snaps at one drive as one."""
    before = dict(zip(second.cells, second.before, strict=True))
    before |= dict(zip(first.cells, first.before, strict=True))
    after = dict(zip(first.cells, first.after, strict=True))
    after |= dict(zip(second.cells, second.after, strict=True))
    cells = tuple(sorted(before))
    return replace(
        first,
        force=(first.force[0], second.force[1]),
        cells=cells,
        before=tuple(before[cell] for cell in cells),
        after=tuple(after[cell] for cell in cells),
        released=first.released + second.released,
        tie=first.tie or second.tie,
    )


def _after(travels: tuple[float, ...], segment: Segment) -> tuple[float, ...]:
    moved = list(travels)
    for cell, travel in zip(segment.cells, segment.after, strict=True):
        moved[cell] = travel
    return tuple(moved)
