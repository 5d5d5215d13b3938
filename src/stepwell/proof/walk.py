"""The path of a chain followed in balls: every event enclosed, every stretch between two proved."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from stepwell.mechanism import Chain, Element
from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, low
from stepwell.proof.laws import EnclosedCell, MonotoneBranch
from stepwell.statics import Configuration, DrivenChain

# Forces closer than this fraction of the largest one tie: their order is not decided.
TIE = 1e-9
# Modes of a cell: it rests at a stop or against friction, moves with λ, or slides one way.
HELD, FREE, SLIDES = range(3)
STOP, TURN, RELEASE, FOLD = "stop", "turn", "release", "fold"


@dataclass
class Stand:
    """Where a cell is: its mode, its branch if it moves, and the sense in which it slides."""

    mode: int
    travel: Ball
    branch: int = 0
    sense: int = 0


class Threshold(NamedTuple):
    """A force λ at which something happens to a cell."""

    force: Ball
    why: str
    cell: int


class Enclosed(NamedTuple):
    """An event of the walk: drive, stroke, λ before and after, and the cells that moved."""

    kind: str  # "switch" or "snap"
    why: str
    direction: int
    drive: Ball
    stroke: Ball
    force: tuple[Ball | None, Ball | None]
    moves: dict[int, tuple[Ball, Ball]]
    released: Ball | None
    theorem: str


class EnclosedWalk:
    """A chain of N cells in balls: where they are, and how they move on."""

    def __init__(self, chain: Chain, problem: DrivenChain):
        self.chain, self.problem = chain, problem
        self.cells = [EnclosedCell(problem, i) for i in range(len(chain))]
        self.alpha, self.beta = problem.alpha, ball(problem.beta)
        self.rigid, self.dead = problem.beta == 0.0, problem.alpha == 0.0
        self.tie = ball(TIE * problem.scale)
        self.mobility: list[float] = problem.mobility.tolist()
        self.stands: list[Stand] = []
        self.force: Ball | None = None
        self.trigger, self.due = (-1, 0), ""
        self.ratio = 1.0
        self.tied: UndecidedError | None = None
        self.stretches = 0

    def stand_at(self, place: Configuration, force: float) -> None:
        """Begin at a configuration: cells at stops exactly, others within 1e-9 of the travel."""
        if any(place.sheet):
            raise UndecidedError("a curve that folds back")
        self.stands = []
        for cell, travel in zip(self.cells, place.travel, strict=True):
            if travel == balls.number(cell.low) or travel == balls.number(cell.high):
                self.stands.append(Stand(HELD, ball(travel)))
            elif cell.rubs:
                self.stands.append(Stand(HELD, ball(travel, 1e-9 * cell.size)))
            else:
                here = ball(travel, 1e-9 * cell.size)
                self.stands.append(Stand(FREE, here, self.branch_at(cell, here, 0)))
        self.trigger, self.due = (-1, 0), ""
        free = any(stand.mode == FREE for stand in self.stands)
        self.force = ball(force, 1e-9 * self.problem.scale) if free or not self.rigid else None

    def settle_at(self, target: Ball) -> None:
        """Solve for the place at a drive exactly, from one that is near."""
        active = self.active()
        if not active or any(self.branch(i).sign <= 0 for i in active):
            return
        assert self.force is not None
        if self.dead:
            self.force = target
        else:

            def miss(force: Ball) -> tuple[Ball, Ball]:
                drive, soft = self.drive_by_force(active, force)
                return target - drive, -soft

            self.force = _root(miss, low(self.force), high(self.force))
        for i in active:
            self._put(i, self.force)

    @staticmethod
    def branch_at(cell: EnclosedCell, travel: Ball, heading: int) -> int:
        """The branch on which a cell is, or goes on in a sense."""
        for k, branch in enumerate(cell.branches):
            after_left = travel >= branch.left or (heading > 0 and travel.overlaps(branch.left))
            before_right = travel <= branch.right or (heading < 0 and travel.overlaps(branch.right))
            if after_left and before_right:
                return k
        raise UndecidedError(f"cell {cell.cell + 1} is too near to a turn of its force")

    def branch(self, i: int) -> MonotoneBranch:
        """The branch of a cell that moves."""
        return self.cells[i].branches[self.stands[i].branch]

    def offset(self, i: int) -> Ball:
        """What λ carries in addition to the force of a moving cell."""
        return self.stands[i].sense * self.cells[i].friction

    def window(self, i: int) -> tuple[Ball | None, Ball | None]:
        """The forces λ between which a held cell stays; None where there is no bound."""
        return self.window_at(i, self.stands[i].travel)

    def window_at(self, i: int, travel: Ball) -> tuple[Ball | None, Ball | None]:
        """The forces λ between which a cell stays that rests at a travel."""
        cell = self.cells[i]
        force = cell.law(travel)[0]
        down = None if travel == cell.low else force - cell.friction
        up = None if travel == cell.high else force + cell.friction
        return down, up

    def stays(self, i: int, force: Ball) -> bool:
        """Whether a held cell is proved to stay at any λ of a ball."""
        down, up = self.window(i)
        return (down is None or bool(force > down)) and (up is None or bool(force < up))

    def windows_meet(self) -> bool:
        """Whether some λ is proved to hold all cells where they are."""
        return windows_meet([self.window(i) for i in range(len(self.cells))])

    def at_end(self, i: int, heading: int) -> bool:
        """Whether a cell is at the end of its travel."""
        end = self.cells[i].high if heading > 0 else self.cells[i].low
        return bool(self.stands[i].travel == end)

    def at_turn(self, i: int) -> bool:
        """Whether a cell stands at a turn of its force, or may do so."""
        at = self.stands[i].travel
        return any(at.overlaps(branch.left) for branch in self.cells[i].branches[1:])

    def stroke(self) -> Ball:
        """u = Σ s_i."""
        total = ball(0.0)
        for stand in self.stands:
            total = total + stand.travel
        return total

    def drive(self) -> Ball:
        """U = α Σ s_i + β λ."""
        out = self.stroke() if not self.dead else ball(0.0)
        return out if self.rigid else out + self.beta * self.force

    def active(self) -> list[int]:
        """Cells that are not held."""
        return [i for i, stand in enumerate(self.stands) if stand.mode != HELD]

    def hold(self, i: int) -> None:
        """Let a cell rest where it is."""
        self.stands[i] = Stand(HELD, self.stands[i].travel)

    # Motion between two turning points of the actuator.

    def turn(self, direction: int) -> None:
        """Turn the actuator: what slides comes to rest."""
        self.trigger, self.due = (-1, 0), ""
        for i, stand in enumerate(self.stands):
            if stand.mode == SLIDES:
                self.hold(i)

    def choose(self, direction: int) -> tuple[int, list[int], int]:
        """Sense of λ with the moving cells and the falling one, or 0 where the chain snaps."""
        follow, falling, flat, blocked = self._kinds(direction)
        if blocked or len(falling) + len(flat) > 1 or self.due:
            return 0, [], falling[0] if falling else -1
        if flat:
            return (direction, flat, flat[0]) if self.rigid else (0, [], -1)
        if not falling:
            return direction, [i for i in follow if self._goes(i, direction)], -1
        leader = falling[0]
        others = [i for i in follow if self._goes(i, -direction)]
        if self.dead or self._snaps(leader, others, direction):
            return 0, [], leader
        return -direction, [leader, *others], leader

    def _kinds(self, direction: int) -> tuple[list[int], list[int], list[int], bool]:
        """Active cells of rising, falling and constant force; whether one slides the other way."""
        kinds: dict[int, list[int]] = {1: [], -1: [], 0: []}
        blocked = False
        for i in self.active():
            sign = self.branch(i).sign
            if sign > 0 or self._goes(i, direction):
                kinds[sign].append(i)
            else:
                blocked = True
        return kinds[1], kinds[-1], kinds[0], blocked

    def _snaps(self, leader: int, others: list[int], direction: int) -> bool:
        """Whether the drive would have to go back for a falling cell to go on."""
        if not others and self.rigid:
            return False
        gain = self._gain_here(leader, others, direction)
        if not (gain > 0 or gain < 0):
            raise UndecidedError("whether the branch goes on at a turn of a force")
        return bool(gain < 0)

    def _goes(self, i: int, sense: int) -> bool:
        return self.stands[i].mode == FREE or self.stands[i].sense == sense

    def _gain_here(self, leader: int, others: list[int], direction: int) -> Ball:
        """dU/ds_j of the falling cell where the chain is."""
        slope = self.cells[leader].law(self.stands[leader].travel, direction)[1]
        soft = self.beta
        for i in others:
            soft = soft + 1 / self.cells[i].law(self.stands[i].travel)[1]
        gain = 1 + slope * soft
        return gain if gain.is_finite() else ball(0.0, 1.0)

    def thresholds(self, toward: int, movers: list[int]) -> Iterator[Threshold]:
        """Forces λ, going one way, at which a cell is released or its branch ends."""
        for i, stand in enumerate(self.stands):
            if stand.mode == HELD:
                bound = self.window(i)[1 if toward > 0 else 0]
                if bound is not None:
                    yield Threshold(bound, RELEASE, i)
        for i in movers:
            branch = self.branch(i)
            travel, force = branch.end(toward * branch.sign or toward)
            at_stop = travel.is_exact()
            yield Threshold(force + self.offset(i), STOP if at_stop else TURN, i)

    def nearest(self, toward: int, movers: list[int]) -> Threshold | None:
        """The first of the thresholds; a tie with another one is raised once it happens."""
        all_of_them, self.tied = list(self.thresholds(toward, movers)), None
        if not all_of_them:
            return None
        first = min(all_of_them, key=lambda one: toward * balls.number(one.force))
        if self.force is not None and toward * (first.force - self.force) < 0:
            raise UndecidedError("a cell is past its critical force")
        for other in all_of_them:
            gap = toward * (other.force - first.force)
            if other.cell != first.cell and not gap > self.tie:
                pair = sorted((first.cell + 1, other.cell + 1))
                cause = f"the order of cells {pair[0]} and {pair[1]}"
                if gap.is_zero():
                    # Cells at rest with slack bands, say: no number could decide it.
                    cause += ", whose forces are equal"
                self.tied = UndecidedError(cause, abs(balls.number(gap)))
        return first

    # Equilibria on given branches, by the travel of one cell or by λ.

    def others_at(self, others: list[int], force: Ball) -> tuple[Ball, Ball, Ball]:
        """Σ s, Σ 1/κ and its slope by λ, of cells on rising branches at a ball of λ."""
        travel, soft, bend = ball(0.0), self.beta, ball(0.0)
        for i in others:
            cell, branch = self.cells[i], self.branch(i)
            s = cell.invert(branch, force - self.offset(i), self.stands[i].travel)
            _, first, second = cell.law_on(branch, s)
            travel, soft = travel + s, soft + 1 / first
            bend = bend - second / (first * first * first)
        return travel, soft, bend

    def gain(self, leader: int, others: list[int], s: Ball, lean: int = 0) -> tuple[Ball, Ball]:
        """dU/ds_j and its slope where the leader is at s and the others follow its force."""
        force, slope, bend = self.cells[leader].law(s, lean)
        _, soft, softer = self.others_at(others, force + self.offset(leader))
        return 1 + slope * soft, bend * soft + slope * slope * softer

    def drive_by_leader(self, leader: int, others: list[int], s: Ball) -> tuple[Ball, Ball]:
        """U and dU/ds_j where the leader is at s and the others follow its force."""
        force, slope, _ = self.cells[leader].law(s)
        force = force + self.offset(leader)
        travel, soft, _ = self.others_at(others, force)
        resting = self.resting({leader, *others})
        return s + travel + resting + self.beta * force, 1 + slope * soft

    def drive_by_force(self, movers: list[int], force: Ball) -> tuple[Ball, Ball]:
        """U and dU/dλ of cells on rising branches."""
        if self.dead:
            return force, ball(1.0)
        travel, soft, _ = self.others_at(movers, force)
        return travel + self.resting(set(movers)) + self.beta * force, soft

    def resting(self, movers: set[int]) -> Ball:
        """Σ s of the cells that do not move."""
        total = ball(0.0)
        for i, stand in enumerate(self.stands):
            if i not in movers:
                total = total + stand.travel
        return total

    # One step: a smooth stretch up to its first event, or a snap.

    def go(self, target: Ball | None, direction: int) -> Iterator[Enclosed]:
        """Events up to a drive, or to the end where all cells are at their stops."""
        self.turn(direction)
        while True:
            toward, movers, leader = self.choose(direction)
            if toward == 0:
                from stepwell.proof.landing import snap

                yield snap(self, direction, leader)
                continue
            for i in self.active():
                if self.stands[i].mode == SLIDES and i not in movers:
                    self.hold(i)
            event = self.nearest(toward, movers)
            if event is None:
                self._end_without_event(target)
                return
            ended, found = self._move(toward, movers, leader, event, target, direction)
            self.stretches += 1
            if found is not None:
                yield found
            if ended:
                return

    def _end_without_event(self, target: Ball | None) -> None:
        if self.rigid:
            return
        assert target is not None
        # Nothing is left to move: the drive only changes the force.
        self.force = (target - (0 if self.dead else self.stroke())) / self.beta

    def _move(
        self,
        toward: int,
        movers: list[int],
        leader: int,
        event: Threshold,
        target: Ball | None,
        direction: int,
    ) -> tuple[bool, Enclosed | None]:
        flat = leader >= 0 and self.branch(leader).sign == 0
        if leader < 0:
            return self._rise(toward, movers, event, target, direction)
        return self._fall(movers, leader, event, target, direction, flat)

    def _rise(self, toward, movers, event, target, direction):
        """λ rises or falls with the drive, all movers on rising branches."""
        there = self.drive_by_force(movers, event.force)[0]
        if target is not None and direction * (target - there) < 0:
            self._reach_by_force(movers, target, event.force)
            return True, None
        self._certain(target, there, direction)
        for i in movers:
            if i != event.cell:
                self._put(i, event.force)
        self.force = event.force
        return False, self._happen(event, direction, toward)

    def _certain(self, target: Ball | None, there: Ball, direction: int) -> None:
        """Prove that an event comes before the turning point, and before all others."""
        if target is not None and not direction * (target - there) > 0:
            raise UndecidedError("whether an event comes before the turning point")
        if self.tied is not None:
            raise self.tied

    def _reach_by_force(self, movers, target, bound):
        """Solve U(λ) = target between the present λ and a bound."""
        begin = self.force

        def miss(force):
            drive, soft = self.drive_by_force(movers, force)
            return target - drive, -soft

        if self.dead:
            self.force = target
        elif movers or not self.rigid:
            self.force = _root(miss, begin, bound)
        for i in movers:
            self._put(i, self.force)

    def _put(self, i: int, force: Ball) -> None:
        stand = self.stands[i]
        stand.travel = self.cells[i].invert(self.branch(i), force - self.offset(i), stand.travel)

    def _fall(self, movers, leader, event, target, direction, flat):
        """One cell on a falling branch leads, and λ runs against the drive."""
        stand, cell = self.stands[leader], self.cells[leader]
        others = [i for i in movers if i != leader]
        end = self._end_of_fall(leader, event, direction)
        fold = None if (self.rigid and not others) else self._fold(leader, others, end)
        at = end if fold is None else fold
        there = self._drive_with(leader, others, at)
        if target is not None and direction * (target - there) < 0:
            self._reach_by_leader(leader, others, target, at)
            return True, None
        self._certain(target, there, direction)
        stand.travel = at
        self.force = cell.law(at)[0] + self.offset(leader)
        if fold is None and not flat:
            self.force = event.force
        for i in others:
            if i != event.cell or fold is not None:
                self._put(i, self.force)
        if fold is not None:
            self.trigger, self.due = (leader, direction), FOLD
            return False, None
        return False, self._happen(event, direction, -direction)

    def _end_of_fall(self, leader: int, event: Threshold, direction: int) -> Ball:
        """The travel of a falling cell at an event."""
        branch = self.branch(leader)
        if event.cell == leader and event.why != RELEASE:
            return branch.end(direction)[0]
        force = event.force - self.offset(leader)
        return self.cells[leader].invert(branch, force, self.stands[leader].travel)

    def _drive_with(self, leader, others, at):
        if self.rigid and not others:
            return at + self.resting({leader})
        return self.drive_by_leader(leader, others, at)[0]

    def _fold(self, leader, others, end):
        """The first travel of the leader at which the branch folds back, or None."""
        begin = self.stands[leader].travel
        heading = 1 if high(end) > high(begin) else -1

        def gain(x):
            value, slope = self.gain(leader, others, start + heading * x)
            return value, heading * slope

        start = high(begin) if heading > 0 else low(begin)
        stop = low(end) if heading > 0 else high(end)
        way = heading * (stop - start)
        if not way > 0:
            return None
        zero = balls.first_zero(gain, ball(0.0), balls.middle(way))
        return None if zero is None else start + heading * zero

    def _reach_by_leader(self, leader, others, target, end):
        stand = self.stands[leader]
        if self.rigid and not others:
            stand.travel = target - self.resting({leader})
        else:

            def miss(s):
                drive, gain = self.drive_by_leader(leader, others, s)
                return target - drive, -gain

            stand.travel = _root(miss, stand.travel, end)
        self.force = self.cells[leader].law(stand.travel)[0] + self.offset(leader)
        for i in others:
            self._put(i, self.force)

    def _happen(self, event: Threshold, direction: int, toward: int) -> Enclosed | None:
        """Change the mode of the cell of an event; returns a switch where it arrives in a phase."""
        i, stand = event.cell, self.stands[event.cell]
        cell = self.cells[i]
        if event.why == RELEASE:
            branch = self.branch_at(cell, stand.travel, toward)
            how = (SLIDES, toward) if cell.rubs else (FREE, 0)
            self.stands[i] = Stand(how[0], stand.travel, branch, how[1])
            self.trigger = i, toward
            return None
        heading = toward * self.branch(i).sign or direction
        before, self.trigger = stand.travel, (i, heading)
        stand.travel = self.branch(i).end(heading)[0]
        # An element arrives in a phase where its force begins to rise; a stop is part of it.
        element = isinstance(self.chain.cells[i], Element)
        arrives = self.branch(i).sign < 0 if element else event.why == STOP
        if event.why != STOP:
            stand.branch += heading
        elif cell.leads[heading > 0]:
            raise UndecidedError("a curve that folds back")
        else:
            self.hold(i)
        return self._switch(i, event.why, direction, before) if arrives else None

    def _switch(self, i: int, why: str, direction: int, before: Ball) -> Enclosed:
        moves = {i: (before, self.stands[i].travel)}
        force = self.force, self.force
        return Enclosed(
            "switch", why, direction, self.drive(), self.stroke(), force, moves, None, ""
        )


def windows_meet(windows: Sequence[tuple[Ball | None, Ball | None]]) -> bool:
    """Whether some λ is proved to be in all windows."""
    lows = [a for a, _ in windows if a is not None]
    highs = [b for _, b in windows if b is not None]
    return all(a < b for a in lows for b in highs)


def _root(f: balls.Smooth, begin: Ball, end: Ball) -> Ball:
    """The root of a function between two places."""
    a, b = (begin, end) if begin < end else (end, begin)
    sign = 1 if f(high(a))[0] > 0 else -1

    def falling(x: Ball) -> tuple[Ball, Ball]:
        value, slope = f(x)
        return sign * value, sign * slope

    zero = balls.first_zero(falling, high(a), low(b))
    if zero is None:
        raise UndecidedError("where the drive reaches its turning point")
    return zero
