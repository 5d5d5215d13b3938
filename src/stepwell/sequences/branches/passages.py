"""The passages of a path along branches, from snap to snap, and their sections, one a state."""

from dataclasses import dataclass, replace

from stepwell.statics import Path, Segment, SegmentKind


@dataclass(frozen=True, slots=True)
class Section:
    """A run of equilibria with the same cells at 0, at 1 and in transit, from a to b."""

    state: str
    drive: tuple[float, float]
    force: tuple[float, float]
    travel: tuple[tuple[float, ...], tuple[float, ...]]

    @property
    def reversed(self) -> "Section":
        """The same run from b to a."""
        (a, b), (f, g), (s, t) = self.drive, self.force, self.travel
        return Section(self.state, (b, a), (g, f), (t, s))

    def until(self, drive: float, force: float, travel: tuple[float, ...]) -> "Section":
        """The run with another end."""
        return replace(
            self,
            drive=(self.drive[0], drive),
            force=(self.force[0], force),
            travel=(self.travel[0], travel),
        )


@dataclass(frozen=True, slots=True)
class Passage:
    """Parts that follow each other smoothly, and the snap that ends them if one does."""

    sections: tuple[Section, ...]
    snap: Segment | None


def state_of(travels: tuple[float, ...], full: tuple[float, ...]) -> str:
    """One character a cell: 0, 1, or - between the stops."""
    return "".join(
        "0" if s == 0 else "1" if s == f else "-" for s, f in zip(travels, full, strict=True)
    )


def passages_of(path: Path) -> list[Passage]:
    """The passages of a path between its snaps."""
    full = path.chain.full_travels
    travels = path.start
    passages: list[Passage] = []

    def resting(drive: float, force: float) -> Section:
        return Section(state_of(travels, full), (drive, drive), (force, force), (travels, travels))

    sections = [resting(path.turning_points[0], path.start_force)]
    landed: Segment | None = None
    for segment in path.segments():
        drive, force = segment.drive[1], segment.force[1]
        if segment.kind is SegmentKind.SNAP:
            if landed is None:
                landed = segment
                passages.append(Passage(tuple(sections), landed))
            else:
                # At a fold rounding may find the fold itself again, and then the way on.
                landed = _joined(landed, segment)
                passages[-1] = replace(passages[-1], snap=landed)
            travels = _after(travels, segment)
            sections = [resting(drive, force)]
            continue
        landed = None
        if segment.kind is SegmentKind.MOVE:
            moving = list(state_of(travels, full))
            for cell, a, b in zip(segment.cells, segment.before, segment.after, strict=True):
                if a != b:
                    moving[cell] = "-"
            state = "".join(moving)
            if state != sections[-1].state:
                at, pull = segment.drive[0], segment.force[0]
                sections.append(Section(state, (at, at), (pull, pull), (travels, travels)))
            travels = _after(travels, segment)
        sections[-1] = sections[-1].until(drive, force, travels)
        if state_of(travels, full) != sections[-1].state:
            sections.append(resting(drive, force))
    passages.append(Passage(tuple(sections), None))
    return passages


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
