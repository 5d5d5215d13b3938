"""Proving a path: the engine's events compared with enclosed ones, stroke by stroke."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from stepwell.base import InputError, check
from stepwell.mechanism import ends_of
from stepwell.proof import balls
from stepwell.proof.balls import UndecidedError
from stepwell.proof.laws import EnclosedCell
from stepwell.proof.path_proof import PathProof, ProofGap, ProvedEvent, Theorem
from stepwell.proof.walk import Enclosed, EnclosedWalk
from stepwell.statics import Configuration, DrivenChain, Event, EventKind, Path, Segment

# Errors of the engine above this fraction of the travel or force contradict it.
_CLOSE = 1e-9
# Travels at which a slope of a force is looked at.
_SAMPLES = 64


class _Stroke(NamedTuple):
    """One stroke of the actuator: its target, and the numbers of its events."""

    begin: float
    target: float
    direction: int
    to_the_end: bool
    events: range


class _State(NamedTuple):
    """Where the engine has the chain: after an event, or at the beginning of a stroke."""

    place: Configuration
    force: float


def prove(
    path: Path,
    *,
    mobility_ratio: float = 1.0,
    claims: Sequence[Event] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> PathProof:
    """Prove a path; all else as for `Path.prove`.

    Args:
        path: the path.
        mobility_ratio: as for `Path.prove`.
        claims: events to prove in place of `path.events`.
        progress: called with (done, total) events.
    """
    if not 1.0 <= check.finite("mobility_ratio", mobility_ratio, "1") <= 1e3:
        raise InputError(f"mobility_ratio = {mobility_ratio:g}: must be between 1 and 1000.")
    return _Prover(path, path.events if claims is None else tuple(claims), mobility_ratio).prove(
        progress
    )


class _Prover:
    def __init__(self, path: Path, claims: tuple[Event, ...], ratio: float):
        self.path, self.claims = path, claims
        self.problem = path._problem
        self.walk = EnclosedWalk(path.chain, self.problem)
        self.walk.ratio = ratio
        self.events: list[ProvedEvent] = []
        self.gaps: list[ProofGap] = []
        self.strokes = list(strokes_of(path, claims, self.problem))
        self.after, self.begins = _states_of(path, len(self.strokes))
        self.size = max(cell.size for cell in self.walk.cells)
        self.stiffest = max(map(_stiffest, self.walk.cells))

    def prove(self, progress: Callable[[int, int], None] | None) -> PathProof:
        """Go through all strokes, and begin again after each gap."""
        ready = self._stand(self.begins[0], self.strokes[0].begin)
        if not ready:
            self._gap(self.strokes[0], None, "where the path begins")
        for k, stroke in enumerate(self.strokes):
            if k > 0 and not ready:
                ready = self._stand(self.begins[k], None)
            at = stroke.events.start
            while True:
                if ready:
                    at, ready = self._follow(stroke, at, progress)
                    if ready:
                        break
                if at >= stroke.events.stop:
                    break
                # The event is a gap; the walk goes on behind it.
                at += 1
                state = self.after[at - 1] if at - 1 < len(self.after) else None
                ready = state is not None and self._stand(state, None)
                if not ready and at >= stroke.events.stop:
                    break
        if self.strokes[-1].events.stop < len(self.claims):
            at = self.strokes[-1].events.stop
            self._gap(self.strokes[-1], at, "an event of the engine does not happen", None, True)
        rest = tuple(self.events), tuple(self.gaps)
        return PathProof(self.path, *rest, self.walk.stretches, self.walk.ratio)

    def _stand(self, state: _State, drive: float | None) -> bool:
        try:
            self.walk.stand_at(*state)
            if drive is not None:
                self.walk.settle_at(balls.ball(drive))
        except UndecidedError:
            return False
        return True

    def _follow(self, stroke: _Stroke, at: int, progress) -> tuple[int, bool]:
        """Go on in a stroke from before event `at`; where it ends, and whether at the end."""
        target = None if stroke.to_the_end else balls.ball(stroke.target)
        try:
            for found in self.walk.go(target, stroke.direction):
                if at >= stroke.events.stop:
                    self._gap(stroke, None, "an event that the engine does not report", None, True)
                    return at, False
                event = self.claims[at]
                proved = self._compared(at, event, found)
                if proved is None:
                    self._gap(stroke, at, "the engine reports another event", None, True)
                    return at, False
                self.events.append(proved)
                at += 1
                if progress is not None:
                    progress(at, len(self.claims))
        except UndecidedError as why:
            self._gap(stroke, at if at < stroke.events.stop else None, why.cause, why.size)
            return at, False
        if at < stroke.events.stop:
            self._gap(stroke, at, "an event of the engine does not happen", None, True)
            return at, False
        return at, True

    def _gap(self, stroke, at, cause, size=None, contradicted=False) -> None:
        drive = stroke.target if at is None else self.claims[at].drive
        if contradicted and self.gaps:
            # Behind a gap the walk begins at the engine's place, which may be next to a tie.
            cause, contradicted = f"{cause}, behind a gap", False
        self.gaps.append(ProofGap(at, drive, stroke.direction, cause, size, contradicted))

    def _compared(self, k: int, event: Event, found: Enclosed) -> ProvedEvent | None:
        """The event with its errors; None where it is another one."""
        scale, walk = self.problem.scale, self.walk
        count = len(walk.cells)
        # The engine states the error of a landing that it integrates; friction keeps it.
        known = sum(one.error for one in self.claims[: k + 1])
        limit, near = max(_CLOSE * self.size, known), _CLOSE * scale + known * self.stiffest
        if not _same_kind(event, found, limit):
            return None
        drives = (0 if walk.dead else limit) + near * self.problem.beta
        forces = zip(found.force, (event.force_before, event.force_after), strict=True)
        released = [(found.released, event.released)] if found.released is not None else []
        drive, stroke, travel, force, heat = (
            _errors([(found.drive, event.drive)], drives * count),
            _errors([(found.stroke, event.stroke)], limit * count),
            _errors(_travels(event, found), limit),
            _errors([one for one in forces if one[0] is not None], near),
            _errors(released, limit * scale),
        )
        every = drive, stroke, travel, force, heat
        if _OTHER in every:
            return None
        theorem = Theorem[found.theorem.upper()] if found.theorem else None
        return ProvedEvent(
            k, event, theorem, drive or 0.0, stroke or 0.0, travel or 0.0, force, heat
        )


def _stiffest(cell: EnclosedCell) -> float:
    """About the largest slope of a cell's force."""
    ends = balls.number(cell.low), balls.number(cell.high)
    steps = (ends[0] + (ends[1] - ends[0]) * k / _SAMPLES for k in range(_SAMPLES + 1))
    return 2.0 * max(abs(balls.number(cell.law(balls.ball(s))[1])) for s in steps)


def _same_kind(event: Event, found: Enclosed, limit: float) -> bool:
    """Whether an event is of the kind, the sense and the cells of an enclosed one.

    A cell may move in a snap and come back: then the engine does not list it.
    """
    if (event.kind is EventKind.SNAP) != (found.kind == "snap"):
        return False
    if event.direction != found.direction:
        return False
    back = {
        i
        for i, (a, b) in found.moves.items()
        if a.overlaps(b) and balls.distance(a - b, 0) <= limit
    }
    own, others = set(event.cells), set(found.moves)
    return len(event.cells) == len(own) and own <= others and others - own <= back


def _travels(event: Event, found: Enclosed) -> list[tuple[balls.Ball, float]]:
    """Enclosed travels, each with that of the engine."""
    # A switch has the beginning of the engine's last segment, of which there may be several.
    sides = (0, 1) if event.kind is EventKind.SNAP else (1,)
    pairs = zip(event.cells, event.before, event.after, strict=True)
    return [
        (found.moves[cell][k], (before, after)[k]) for cell, before, after in pairs for k in sides
    ]


# The bound of an error if the engine's number is not in the enclosure.
_OTHER = math.inf


def _errors(pairs: Sequence[tuple[balls.Ball, float]], limit: float) -> float | None:
    """The largest distance of numbers to enclosed ones; None without any, inf for wrong numbers."""
    if not pairs:
        return None
    worst = max(balls.distance(x, value) for x, value in pairs)
    if worst <= limit:
        return worst
    if any(abs(x - value) > limit for x, value in pairs):
        return _OTHER
    raise UndecidedError("an enclosure is too wide to bound an error")


def strokes_of(path: Path, events: Sequence[Event], problem: DrivenChain) -> Iterator[_Stroke]:
    """The strokes of a path; turning points at which the actuator goes on in its sense are none."""
    points = [path.turning_points[0]]
    for point in path.turning_points[1:]:
        if point == points[-1]:
            continue
        if len(points) > 1 and (point > points[-1]) == (points[-1] > points[-2]):
            points.pop()
        points.append(point)
    lowest, highest = ends_of(problem.sheets)
    slack = 1e-13 * (highest - lowest)
    rigid, at = problem.beta == 0.0, 0
    for begin, target in pairwise(points):
        direction = 1 if target > begin else -1
        end = target >= highest - slack if direction > 0 else target <= lowest + slack
        first = at
        while at < len(events) and events[at].direction == direction:
            at += 1
        yield _Stroke(begin, target, direction, rigid and end, range(first, at))


def _states_of(path: Path, strokes: int) -> tuple[list[_State], list[_State]]:
    """The engine's states after each event, and at the beginning of each stroke."""
    travel, sheet = list(path.start), list(path.start_sheet)
    state = _State(Configuration(path.start, path.start_sheet), path.start_force)
    after: list[_State] = []
    begins, direction, events, at = [state], 0, path.events, 0
    for segment in path.segments():
        if direction and segment.direction != direction:
            begins.append(state)
        direction = segment.direction
        for k, cell in enumerate(segment.cells):
            travel[cell], sheet[cell] = segment.after[k], segment.sheets_after[k]
        state = _State(Configuration(tuple(travel), tuple(sheet)), segment.force[1])
        while at < len(events) and _ends_with(segment, events[at]):
            after.append(state)
            at += 1
    return after, begins + [state] * (strokes - len(begins))


def _ends_with(segment: Segment, event: Event) -> bool:
    """Whether an event is the end of a segment."""
    snap = event.kind is EventKind.SNAP
    if snap != (segment.cause is not None) or event.direction != segment.direction:
        return False
    return event.drive == segment.drive[0 if snap else 1] and event.cells[0] in segment.cells
