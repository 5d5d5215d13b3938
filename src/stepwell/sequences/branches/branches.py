"""The branches that a chain without friction can stand on, found by driving it up and down.

A *branch* is a stretch of stable equilibria along which the chain goes to and fro with the
drive; at either end it snaps, or the drive ends. Turning back within a branch does nothing
new. So whatever an actuator can do to the chain is known once the two ends of every branch
are, and each costs one run of the engine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from stepwell.base import InputError, most, problem
from stepwell.mechanism import Chain
from stepwell.sequences.branches.passages import Passage, Section, passages_of, state_of
from stepwell.statics import (
    Configuration,
    Landing,
    Path,
    Problem,
    Segment,
    Tie,
    drive_range,
    path,
    problem_of,
    standing,
)

# Two places are one when they differ by less than this share of what there is to travel.
_SAME = 1e-7
# Below this share of a drive's range its rounding begins.
_ROUNDING = 1e-14
# How far past the last event a drive without stops is looked at, as a share of its range.
_BEYOND = 0.1

# The snap that ends a passage, and place and drive after it; None where the drive ends.
After = tuple[Segment, Configuration, float] | None


@dataclass(frozen=True, slots=True)
class Exit:
    """The snap at an end of a branch, and the branch that it leads to."""

    snap: Segment
    place: Configuration  # after it
    branch: int


@dataclass(frozen=True, slots=True)
class Branch:
    """Parts in rising order of the drive.

    Attributes:
        sections: the parts.
        begin: where the chain stood when the branch was found.
        drive: the drive there [m], or [N] under force control.
    """

    sections: tuple[Section, ...]
    begin: Configuration
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


def reach(chain: Chain, known: Problem | None = None) -> tuple[float, float]:
    """The drives between which a chain is looked at [m], or [N] under force control.

    A rigid actuator ends at the stops; any other can pull further and nothing changes. Curves that
    fold back may be longer in an earlier phase than in a later one.

    Args:
        chain: what is driven.
        known: the problem that it sets, where it is at hand.
    """
    low, high = drive_range(chain, known)
    more = 0.0 if math.isinf(chain.actuator_stiffness) else _BEYOND * (high - low)
    if chain.actuator_stiffness > 0 and any(len(cell.laws) > 1 for cell in chain.elements):
        more += sum(cell.full_travel for cell in chain.elements if len(cell.laws) > 1) / 2.0
    return low - more, high + more


def drive_slip(span: float, stroke: float) -> float:
    """Drives closer than this are one place.

    Behind a soft spring the drive goes far to change the force a little, and what tells one
    place from another is still no more than a stroke.

    Args:
        span: of all drives [m], or [N] under force control.
        stroke: with every cell at 1 [m], as far as the drive contains it; 0 under force control.
    """
    return max(_SAME * (stroke or span), _ROUNDING * span)


class Branches:
    """The branches of one chain, each followed when it is first asked for.

    Args:
        chain: no friction: with it a chain that turns back does not go the way it came.
    """

    def __init__(self, chain: Chain):
        self.chain = chain
        self._rigid = math.isinf(chain.actuator_stiffness)
        self._problem = problem_of(chain)
        self.range = reach(chain, self._problem)
        stroke = 0.0 if chain.actuator_stiffness == 0 else chain.full_stroke
        self.slip = drive_slip(self.range[1] - self.range[0], stroke)
        self.ties: dict[Tie, None] = {}
        self._stretches = chain.stretches
        self._levers = not chain.elements
        self._branches: list[Branch] = []
        self._after: dict[tuple[int, int], After] = {}
        self._landings: dict[tuple[int, int, float], Landing] = {}
        self._where: dict[str, list[int]] = {}
        self._passages: dict[tuple[int, ...], tuple[Passage, After]] = {}

    def __getitem__(self, number: int) -> Branch:
        return self._branches[number]

    def __len__(self) -> int:
        return len(self._branches)

    def at(self, place: Configuration, drive: float) -> int:
        """Number of the branch on which the chain stands there."""
        state = state_of(self._stretches, place)
        known = self._known(state, drive)
        if known is not None:
            return known
        up, after_up = self._passage(place, drive, +1)
        down, after_down = self._passage(place, drive, -1)
        back = [section.reversed for section in reversed(down.sections)]
        first = up.sections[0]
        # Both runs begin with the section that the chain stands on.
        middle = back[-1].until(first.drive[1], first.force[1], first.place[1])
        branch = Branch((*back[:-1], middle, *up.sections[1:]), place, drive)
        number = self._same(branch)
        if number is None:
            number = len(self._branches)
            self._branches.append(branch)
            for section in branch.sections:
                self._where.setdefault(section.state, []).append(number)
            self._after[number, +1] = after_up
            self._after[number, -1] = after_down
        return number

    def exit(self, number: int, direction: int) -> Exit | None:
        """The snap at the upper (+1) or lower (-1) end of a branch; None where the drive ends."""
        after = self._after[number, direction]
        if after is None:
            return None
        snap, place, drive = after
        return Exit(snap, place, self.at(place, drive))

    def landing(self, number: int, direction: int, ratio: float) -> Landing:
        """Whether the snap at an end of a branch lands there for all mobilities within a ratio.

        Of several that follow one another at once the first that does not hold, if there is one.
        """
        key = number, direction, ratio
        if key not in self._landings:
            exit_ = self.exit(number, direction)
            assert exit_ is not None
            branch, onto = self[number], self[exit_.branch]
            # Past this snap, and not as far as the next.
            past = (exit_.snap.drive[1] + (onto.high if direction > 0 else onto.low)) / 2.0
            found = path(self.chain, [branch.drive, past], start=branch.begin).landings(ratio)
            self._landings[key] = next((one for one in found if not one.holds), found[0])
        return self._landings[key]

    def vertex(self, state: str) -> tuple[Configuration, float] | None:
        """Configuration and drive of a state such as "010", or None where it is no equilibrium.

        Of all places in that state the one of the force that is nearest to none.
        """
        return standing(self.chain, self._problem, state)

    def all_from(
        self, numbers: list[int], progress: Callable[[int, int], None] | None = None
    ) -> set[int]:
        """Every branch that can be reached from these, themselves included.

        `progress` is called with (followed, known) branches.

        Raises:
            ValueError: more branches than the limit.
        """
        seen, waiting, limit = set(numbers), list(numbers), most("branches")
        while waiting:
            if len(seen) > limit:
                found = problem("branches", len(seen), "there are", so_far=True)
                raise InputError(
                    f"{found} Or look at a shorter chain, walk only so far with "
                    f"chain.implicit_graph().walk(most=...), or ask chain.program(to=...) for one "
                    f"way."
                )
            if progress is not None:
                progress(max(0, len(seen) - len(waiting)), len(seen))
            number = waiting.pop()
            for direction in (+1, -1):
                way = self.exit(number, direction)
                if way is not None and way.branch not in seen:
                    seen.add(way.branch)
                    waiting.append(way.branch)
        return seen

    def _known(self, state: str, drive: float) -> int | None:
        """The branch known to hold this place, where state and drive tell it.

        A vertex stands at all forces between two, so that there is one of each state; two of
        lever cells under a rigid actuator may meet at a tie. That tells more: where a single cell
        is in transit between stops, its travel is what is left of the stroke.
        """
        if not (self._rigid and self._levers):
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

    def _same(self, branch: Branch) -> int | None:
        states = [section.state for section in branch.sections]
        for number in self._where.get(states[0], ()):
            other = self._branches[number]
            # Slack cells that share a motion differ in nothing but the places within a branch.
            if states == [p.state for p in other.sections] and all(
                abs(a - b) <= self.slip
                for section, like in zip(branch.sections, other.sections, strict=True)
                for a, b in zip(section.drive, like.drive, strict=True)
            ):
                return number
        return None

    def _key(self, place: Configuration, drive: float, direction: int) -> tuple[int, ...]:
        least = _SAME * self.chain.full_stroke
        travels = (round(s / least) for s in place.travel)
        return (*travels, *place.sheet, round(drive / self.slip), direction)

    def _passage(self, place: Configuration, drive: float, direction: int) -> tuple[Passage, After]:
        key = self._key(place, drive, direction)
        if key not in self._passages:
            end = self.range[1] if direction > 0 else self.range[0]
            found = path(self.chain, [drive, end], start=place)
            self._keep(found, direction)
        return self._passages[key]

    def _keep(self, found: Path, direction: int) -> None:
        """Write down every passage of a run: the later ones begin where a snap ended."""
        for tie in found.degenerate:
            self.ties.setdefault(tie)
        passages = passages_of(found)
        for passage, following in zip(passages, [*passages[1:], None], strict=True):
            first = passage.sections[0]
            place, drive = first.place[0], first.drive[0]
            key = self._key(place, drive, direction)
            after = None
            if passage.snap is not None and following is not None:
                begin = following.sections[0]
                after = passage.snap, begin.place[0], begin.drive[0]
            self._passages.setdefault(key, (passage, after))
