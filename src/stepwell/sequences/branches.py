"""Equilibrium branches of a chain, computed by driving it; a chain as one element."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stepwell import statics
from stepwell.base import Floats, InputError, Progress, amount, most, notify, problem
from stepwell.mechanism import Chain, Element, Sheet, through
from stepwell.sequences.passages import Passage, SmoothRun, passages_of, state_of

Drive = str | float | None


def driven(chain: Chain, drive: Drive) -> Chain:
    """The chain with the actuator named by `drive`."""
    if drive is None:
        return chain
    if isinstance(drive, str):
        measure = chain.measure
        known = {"stroke": math.inf, "force": 0.0, measure.stroke: math.inf, measure.force: 0.0}
        if drive not in known:
            raise InputError(
                f"drive = {drive!r}: must be {measure.stroke!r}, {measure.force!r}, or the "
                f"stiffness of the actuator [{measure.stiffness_unit}]."
            )
        return replace(chain, actuator_stiffness=known[drive])
    return replace(chain, actuator_stiffness=drive)


def refuse_friction(chain: Chain) -> None:
    """Raise ValueError where a cell has friction."""
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if cell.friction > 0:
            friction = amount(cell.friction, chain.measure.force_unit)
            raise InputError(
                f"{name} has friction {friction}: a chain with friction can stop at any turning "
                f"point, so it has no finite graph. Omit friction for a graph, or use "
                f"chain.program(), which searches programs with friction."
            )


def checked_state(chain: Chain, name: str, state: str) -> str:
    """The state, if the chain can have it; raises ValueError otherwise."""
    statics.read_state(chain, name, state)
    return state


# Two places are one when they differ by less than this fraction of the full travel.
_SAME = 1e-7
# Rounding of a drive, as a fraction of its range.
_ROUNDING = 1e-14
# Range past the last event of a drive without stops, as a fraction of its range.
_BEYOND = 0.1

# The snap that ends a passage, and place and drive after it; None where the drive ends.
After = tuple[statics.Segment, statics.Configuration, float] | None


@dataclass(frozen=True, slots=True)
class Exit:
    """The snap at an end of a branch, and the branch that it leads to."""

    snap: statics.Segment
    place: statics.Configuration  # after it
    branch: int


@dataclass(frozen=True, slots=True)
class Branch:
    """Sections of a branch in rising order of the drive.

    `begin` is a configuration on it, at `drive` [m, or N under force control].
    """

    sections: tuple[SmoothRun, ...]
    begin: statics.Configuration
    drive: float

    @property
    def low(self) -> float:
        """Drive at the lower end [m], or [N] under force control."""
        return self.sections[0].drive[0]

    @property
    def high(self) -> float:
        """Drive at the upper end."""
        return self.sections[-1].drive[1]

    @property
    def vertices(self) -> tuple[str, ...]:
        """States on it with all cells in a phase, by rising drive."""
        return tuple(section.state for section in self.sections if "-" not in section.state)

    def find(self, state: str, drive: float) -> int:
        """Number of the section with this state at this drive, or the nearest to it."""
        outside = {
            max(section.drive[0] - drive, drive - section.drive[1], 0.0): k
            for k, section in reversed(list(enumerate(self.sections)))
            if section.state == state
        }
        return outside[min(outside)]


def reach(chain: Chain, known: statics.DrivenChain | None = None) -> tuple[float, float]:
    """The range of drives in which a chain is followed [m], or [N] under force control.

    A rigid actuator ends at the stops; any other can go further without a change. Curves that fold
    back may be longer in an earlier phase than in a later one.
    """
    low, high = statics.drive_range(chain, known)
    more = 0.0 if math.isinf(chain.actuator_stiffness) else _BEYOND * (high - low)
    if chain.actuator_stiffness > 0:
        more += sum(cell.full_travel for cell in chain.elements if len(cell.laws) > 1) / 2.0
    return low - more, high + more


def drive_slip(span: float, stroke: float) -> float:
    """Tolerance below which two drives are one place, in a span of drives.

    Behind a soft spring a large drive changes the force a little, so the stroke is the measure of
    the distance of places (0 under force control, where it has none).
    """
    return max(_SAME * (stroke or span), _ROUNDING * span)


class Branches:
    """The branches of a chain without friction, each followed on first use.

    With friction a chain that turns back does not return along the same branch.
    """

    def __init__(self, chain: Chain):
        self.chain = chain
        self._rigid_levers = math.isinf(chain.actuator_stiffness) and not chain.elements
        self._problem = statics.problem_of(chain)
        self.range = reach(chain, self._problem)
        stroke = 0.0 if chain.actuator_stiffness == 0 else chain.full_stroke
        self.slip = drive_slip(self.range[1] - self.range[0], stroke)
        self.ties: dict[statics.Tie, None] = {}
        self._stretches = chain.stretches
        self._branches: list[Branch] = []
        self._after: dict[tuple[int, int], After] = {}
        self._landings: dict[tuple[int, int, float], statics.Landing] = {}
        self._where: dict[str, list[int]] = {}
        self._passages: dict[tuple[int, ...], tuple[Passage, After]] = {}

    def __getitem__(self, number: int) -> Branch:
        return self._branches[number]

    def __len__(self) -> int:
        return len(self._branches)

    def at(self, place: statics.Configuration, drive: float) -> int:
        """Number of the branch that contains a configuration at a drive."""
        state = state_of(self._stretches, place)
        known = self._known_branch(state, drive)
        if known is not None:
            return known
        up, after_up = self._passage(place, drive, +1)
        down, after_down = self._passage(place, drive, -1)
        back = [section.reversed for section in reversed(down.sections)]
        first = up.sections[0]
        # Both runs begin with the section that the chain stands on.
        middle = back[-1].until(first.drive[1], first.force[1], first.place[1])
        branch = Branch((*back[:-1], middle, *up.sections[1:]), place, drive)
        number = self._equal_branch(branch)
        if number is None:
            number = len(self._branches)
            self._branches.append(branch)
            for section in branch.sections:
                self._where.setdefault(section.state, []).append(number)
            self._after |= {(number, +1): after_up, (number, -1): after_down}
        return number

    def exit(self, number: int, direction: int) -> Exit | None:
        """The snap at the upper (+1) or lower (-1) end of a branch; None where the drive ends."""
        after = self._after[number, direction]
        if after is None:
            return None
        snap, place, drive = after
        return Exit(snap, place, self.at(place, drive))

    def landing(self, number: int, direction: int, ratio: float) -> statics.Landing:
        """Robustness of the landing at an end of a branch for all mobilities within a ratio.

        If several snaps follow at once: the first landing that does not hold, if there is one.
        """
        key = number, direction, ratio
        if key not in self._landings:
            exit_ = self.exit(number, direction)
            assert exit_ is not None
            branch, onto = self[number], self[exit_.branch]
            # Past this snap, and not as far as the next.
            past = (exit_.snap.drive[1] + (onto.high if direction > 0 else onto.low)) / 2.0
            run = statics.path(self.chain, [branch.drive, past], start=branch.begin)
            landings = run.landings(ratio)
            self._landings[key] = next((one for one in landings if not one.holds), landings[0])
        return self._landings[key]

    def vertex(self, state: str) -> tuple[statics.Configuration, float] | None:
        """Configuration and drive of a state such as "010", or None where it is no equilibrium.

        Of all places in that state the one with the smallest force in size.
        """
        return statics.standing(self.chain, self._problem, state)

    def all_from(self, numbers: list[int], progress: Progress = None) -> set[int]:
        """Every branch that can be reached from these, themselves included.

        `progress` is called with (followed, known) branches.
        """
        seen, waiting, limit = set(numbers), list(numbers), most("branches")
        while waiting:
            if len(seen) > limit:
                text = problem("branches", len(seen), "there are", so_far=True)
                raise InputError(
                    f"{text} Or use a shorter chain, limit the walk with "
                    f"chain.implicit_graph().walk(most=...), or use chain.program(target=...) for "
                    f"one program."
                )
            notify(progress, max(0, len(seen) - len(waiting)), len(seen))
            number = waiting.pop()
            for direction in (+1, -1):
                way = self.exit(number, direction)
                if way is not None and way.branch not in seen:
                    seen.add(way.branch)
                    waiting.append(way.branch)
        return seen

    def _known_branch(self, state: str, drive: float) -> int | None:
        """The known branch that contains this place, if state and drive decide it.

        A vertex exists at all forces of an interval, so there is one of each state. The exception:
        two of lever cells under a rigid actuator may meet at a tie. There the drive decides more:
        if a single cell is in transit between stops, its travel is the remainder of the stroke.
        """
        if not self._rigid_levers:
            vertices = self._where.get(state, ()) if "-" not in state else ()
            return next(iter(vertices), None)
        if state.count("-") > 1:
            return None
        for number in self._where.get(state, ()):
            for section in self._branches[number].sections:
                low, high = section.drive
                if section.state == state and low - self.slip <= drive <= high + self.slip:
                    return number
        return None

    def _equal_branch(self, branch: Branch) -> int | None:
        states = [section.state for section in branch.sections]
        for number in self._where.get(states[0], ()):
            other = self._branches[number]
            # Slack cells that share a motion differ only in the places within a branch.
            if states == [p.state for p in other.sections] and all(
                abs(a - b) <= self.slip
                for section, like in zip(branch.sections, other.sections, strict=True)
                for a, b in zip(section.drive, like.drive, strict=True)
            ):
                return number
        return None

    def _key(self, place: statics.Configuration, drive: float, direction: int) -> tuple[int, ...]:
        least = _SAME * self.chain.full_stroke
        travels = (round(s / least) for s in place.travel)
        return (*travels, *place.sheet, round(drive / self.slip), direction)

    def _passage(
        self, place: statics.Configuration, drive: float, direction: int
    ) -> tuple[Passage, After]:
        key = self._key(place, drive, direction)
        if key not in self._passages:
            run = statics.path(self.chain, [drive, self.range[direction > 0]], start=place)
            self._store_passages(run, direction)
        return self._passages[key]

    def _store_passages(self, run: statics.Path, direction: int) -> None:
        """Store every passage of a run: the later ones begin where a snap ended."""
        self.ties |= dict.fromkeys(run.degenerate)
        passages = passages_of(run)
        for passage, following in zip(passages, [*passages[1:], None], strict=True):
            place, drive = _begin(passage)
            after = None
            if passage.snap is not None and following is not None:
                after = passage.snap, *_begin(following)
            self._passages.setdefault(self._key(place, drive, direction), (passage, after))


def _begin(passage: Passage) -> tuple[statics.Configuration, float]:
    return passage.sections[0].place[0], passage.sections[0].drive[0]


def windows(
    chain: Chain, start: str, turning_points: tuple[float, ...]
) -> list[tuple[float, float]]:
    """Windows of all turning points but the first and the last: drives with the same effect.

    A turn anywhere between the previous snap and the next one leads back along the same branch.
    With friction it does not, and a turning point has no window.
    """
    inner = turning_points[1:-1]
    if any(cell.friction > 0 for cell in chain.cells):
        return [(point, point) for point in inner]
    begin: str | statics.Configuration = start
    limits = reach(chain)
    intervals: list[tuple[float, float]] = []
    for before, point in pairwise(turning_points[:-1]):
        rises = point > before
        end = max(point, limits[1]) if rises else min(point, limits[0])
        whole = statics.path(chain, [before, end], start=begin)
        snaps = [event.drive for event in whole.events if event.kind is statics.EventKind.SNAP]
        passed = [drive for drive in snaps if (drive <= point) == rises or drive == point]
        ahead = [drive for drive in snaps if drive not in passed]
        last = passed[-1] if passed else before
        next_ = ahead[0] if ahead else whole.turning_points[-1]
        intervals.append((min(last, next_), max(last, next_)))
        begin = statics.path(chain, [before, point], start=begin).end_configuration
    return intervals


# Points on every section of a branch, closer towards its ends, where the force may turn sharply.
_POINTS = 129
# Width of a force step at one travel, as where all cells are at stops, as a fraction of the travel.
_RAMP = 1e-6


def element_of(chain: Chain, name: str = "") -> Element:
    """A chain as one element. All else as for `Element.from_chain`."""
    refuse_friction(chain)
    branches = Branches(replace(chain, actuator_stiffness=math.inf))
    place = branches.vertex(chain.first_state)
    # In their first phases all cells are stable at a sufficiently low force.
    assert place is not None
    numbers = sorted(branches.all_from([branches.at(*place)]))
    own = {number: k for k, number in enumerate(numbers)}
    width = _RAMP * (branches.range[1] - branches.range[0])
    sheets: list[Sheet] = []
    for number in numbers:
        below, above = (
            None if (way := branches.exit(number, direction)) is None else own[way.branch]
            for direction in (-1, +1)
        )
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
    sections = [a + (b - a) * dense for a, b in (s.drive for s in branch.sections)]
    grid = np.unique(np.concatenate(sections))
    down = _points(chain, branch, [branch.drive, *grid[grid < branch.drive][::-1].tolist()])
    up = _points(chain, branch, [branch.drive, *grid[grid > branch.drive].tolist()])
    u, force = np.array([*reversed(down[0]), *up[0][1:]]).T
    places = zip(chain.cells, down[1].travel, down[1].sheet, strict=True)
    return u, force, math.fsum(float(cell.energy_at(s, sheet)) for cell, s, sheet in places)


def _points(
    chain: Chain, branch: Branch, turns: list[float]
) -> tuple[list[tuple[float, float]], statics.Configuration]:
    """(stroke, force) through these strokes, up to a snap, and the configuration at the end."""
    run = statics.path(chain, turns, start=branch.begin)
    points, travels, sheets = [(turns[0], run.start_force)], [*run.start], [*run.start_sheet]
    for segment in run.segments():
        if segment.kind is statics.SegmentKind.SNAP:
            break
        for cell, travel in zip(segment.cells, segment.after, strict=True):
            travels[cell] = travel
        point = segment.drive[1], segment.force[1]
        if point != points[-1]:
            points.append(point)
    return points, statics.Configuration(tuple(travels), tuple(sheets))


def _ramped(u: Floats, width: float) -> Floats:
    """The same strokes, each at least `width` from the one before."""
    out = u.copy()
    for k in range(1, len(out)):
        out[k] = max(out[k], out[k - 1] + width)
    # Scaled back, so that the curve ends at the same stroke.
    return u[0] + (out - u[0]) * ((u[-1] - u[0]) / (out[-1] - u[0]))
