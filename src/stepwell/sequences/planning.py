"""Finding the shortest stroke program: by a theorem, by all branches, with friction by a search."""

import heapq
import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import count
from typing import NamedTuple

from stepwell.base import InputError, amount, bisected
from stepwell.concave import Relays, fewest_strokes, relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches, checked_state
from stepwell.sequences.passages import Order, SmoothRun, order_kept, passages_of, state_of
from stepwell.sequences.programs import Program, ProgramMethod, Turn, Unreachable
from stepwell.statics import Configuration, Landing, StaticsError, a_ratio, path

_MOST_TURNS = 6
_MOST_PLACES = 4000
# Places closer than this share of all that can be travelled and driven are not both tried.
_SAME = 1e-4


def search_with_friction(
    branches: Branches,
    start: str,
    target: str,
    origin: tuple[Configuration, float],
    progress: Callable[[int, int], None] | None,
    robust: float | None,
) -> Program:
    """The first program found, fewest turns first; as `sequences.program`."""
    chain = branches.chain
    least, slip = _SAME * chain.full_stroke, _SAME * (branches.range[1] - branches.range[0])
    waiting: deque[tuple[Configuration, float, int, tuple[float, ...]]] = deque()
    for direction in (+1, -1):
        waiting.append((*origin, direction, ()))
    seen: set[tuple[int, ...]] = set()
    while waiting and len(seen) < _MOST_PLACES:
        place, drive, direction, turns = waiting.popleft()
        travels = (round(s / least) for s in place.travel)
        key = (*travels, *place.sheet, round(drive / slip), direction)
        if key in seen:
            continue
        seen.add(key)
        if progress is not None:
            progress(len(seen), _MOST_PLACES)
        for section in _sections(chain, place, drive, branches.range[direction > 0]):
            if section.state == target:
                low, high = sorted(section.drive)
                wish = _Wish(start, target, robust)
                found = _widened(branches, wish, origin, turns, (low, high))
                if found is not None:
                    return found
            if len(turns) < _MOST_TURNS and section.drive[0] != section.drive[1]:
                middle = sum(section.drive) / 2
                stopped = path(chain, [drive, middle], start=place).end_configuration
                waiting.append((stopped, middle, -direction, (*turns, middle)))
    raise Unreachable(
        f"no program from {start} to {target} was found: {len(seen)} places with up to "
        f"{_MOST_TURNS} turns were tried, turning in the middle of every smooth part. With "
        f"friction that is a search and no proof; without friction the answer would be certain.",
        proved=False,
    )


def _sections(chain: Chain, place: Configuration, drive: float, end: float) -> list[SmoothRun]:
    try:
        passages = passages_of(path(chain, [drive, end], start=place))
        return [section for passage in passages for section in passage.sections]
    except (StaticsError, ValueError):
        # A place between two events that balance to the last digit: others are near by.
        return []


class _Wish(NamedTuple):
    """From where to where, and within which ratio of mobilities its landings have to hold."""

    start: str
    target: str
    robust: float | None


def _widened(
    branches: Branches,
    wish: _Wish,
    origin: tuple[Configuration, float],
    turns: tuple[float, ...],
    ends: tuple[float, float],
) -> Program | None:
    """The program, each window bisected with the other turns where they are.

    None where one of its landings hangs on the mobilities.
    """
    chain, (start, target, robust) = branches.chain, wish
    points = [origin[1], *turns, sum(ends) / 2]

    def works(k: int, drive: float) -> bool:
        try:
            found = path(chain, [*points[:k], drive, *points[k + 1 :]], start=origin[0])
        except (StaticsError, ValueError):
            return False
        arrives = state_of(chain.stretches, found.end_configuration) == target
        return arrives and (robust is None or all(x.holds for x in found.landings(robust)))

    if robust is not None and not works(0, points[0]):
        return None
    windows: list[Turn] = []
    for k in range(1, len(points) - 1):
        rises = points[k] > points[k - 1]
        inner = max(points[k - 1], points[k + 1]) if rises else min(points[k - 1], points[k + 1])
        outer = branches.range[1] if rises else branches.range[0]
        # The drive furthest towards each of the two at which the turn still works.
        low, high = sorted(
            far if works(k, far) else bisected(partial(works, k), points[k], far, 30)[0]
            for far in (inner, outer)
        )
        points[k] = (low + high) / 2
        windows.append(Turn(points[k], low, high, ()))
    method = ProgramMethod.FRICTION
    found = chain, start, target, origin[1], tuple(windows), *ends, method, False, origin[0]
    return Program(*found, robust)


# Up to this many cells every branch is looked at; beyond, sorted fields plan where they may.
_LOOKED_AT = 6
# Branches after which a search gives up without an answer.
_MOST_BRANCHES = 20_000

Progress = Callable[[int, int], None]


def program(
    chain: Chain,
    target: str,
    *,
    start: str | None = None,
    robust: float | None = None,
    progress: Progress | None = None,
) -> Program:
    """The shortest list of turning points of the actuator from one state to another.

    All else as for `Chain.program`.
    """
    start = checked_state(chain, "start", chain.first_state if start is None else start)
    checked_state(chain, "target", target)
    robust = None if robust is None else a_ratio("robust", robust)
    try:
        return _planned(chain, start, target, robust, progress)
    except Unreachable as why:
        why.chain, why.start, why.target, why.robust = chain, start, target, robust
        raise


def _planned(
    chain: Chain, start: str, target: str, robust: float | None, progress: Progress | None
) -> Program:
    branches = Branches(chain)
    origin = _origin(branches, start, target)
    rubbed = any(cell.friction > 0 for cell in chain.cells)
    by_fields = None if rubbed else partial(_by_fields, branches, start, target, origin)
    search = search_with_friction if rubbed else _by_branches
    found = by_fields() if by_fields and len(chain) > _LOOKED_AT else None
    found = found or search(branches, start, target, origin, progress, None)
    if robust is None:
        return found
    found = replace(found, robust=robust)
    if found.hangs is None:
        return found
    turned = by_fields(robust) if by_fields else None
    if turned is not None:
        shortest = found.shortest and turned.strokes == found.strokes
        return replace(turned, shortest=shortest)
    try:
        return search(branches, start, target, origin, progress, robust)
    except Unreachable as why:
        text = _hanging(found, found.hangs) + ("" if why.proved else f" {_NO_PROOF}")
        raise Unreachable(text, proved=why.proved) from None


def _origin(branches: Branches, start: str, target: str) -> tuple[Configuration, float]:
    """Where the chain stands at the start, and the drive there, if it can stand in both states."""
    origin = branches.vertex(start)
    if origin is None:
        raise InputError(f"start: {_unstable(branches.chain, start)}")
    if branches.vertex(target) is None:
        raise Unreachable(_unstable(branches.chain, target), proved=True)
    return origin


_NO_PROOF = "That is no proof: not all ways could be looked at, or a tie stands in one."


def _hanging(found: Program, hangs: Landing) -> str:
    """What stands in the way of a program that works for all mobilities within a ratio."""
    event, place = hangs.event, hangs.elsewhere[0]
    at = amount(event.drive, found.chain.drive_unit, 4)
    way = "up" if event.direction > 0 else "down"
    cells = ", ".join(found.chain.names[cell] for cell in event.cells)
    factors = ", ".join(f"{one:.3g}" for one in place.mobility)
    return (
        f"no program leads from {found.start} to {found.target} on which every snap lands in one "
        f"place for all mobilities up to {hangs.ratio:g} apart. On the shortest, {found}, the "
        f"snap at {at} on the way {way} ({cells}) stands in the way: with {factors} times the "
        f"mobilities given it lands in {place.state}. Ask for a smaller ratio or another state, or "
        f"move an anchor."
    )


def _unstable(chain: Chain, state: str) -> str:
    cells = list(zip(chain.names, chain.cells, state, strict=True))
    least = [(c.phases[int(at)].force_low - c.friction, name, at) for name, c, at in cells]
    most = [(c.phases[int(at)].force_high + c.friction, name, at) for name, c, at in cells]
    (pushes, pushed, low), (gives, giving, high) = max(least), min(most)
    kind, unit = chain.measure.force, chain.measure.force_unit
    f1, f0 = ("the least there", "the largest there") if chain.elements else ("F1", "F0")
    return (
        f"{state} is no equilibrium, so the chain cannot stand there: at {low} {pushed} needs an "
        f"actuator {kind} of at least {amount(pushes, unit)} ({f1} less friction), and at {high} "
        f"{giving} lets go at {amount(gives, unit)} ({f0} and friction)."
    )


def _by_fields(
    branches: Branches,
    start: str,
    target: str,
    origin: tuple[Configuration, float],
    robust: float | None = None,
) -> Program | None:
    """The plan of relays, aimed by one run a stroke; None where it may not or does not hold.

    Under a prescribed stroke one that is to be `robust` turns past vertices only. Which cell is
    left in transit before them hangs on the mobilities, and they do not.

    Source: theory page, "Stroke programs" (a).
    """
    chain = branches.chain
    fields = relays(chain)
    if fields is None or fields.skips:
        return None
    by_force = chain.actuator_stiffness == 0
    if not by_force:
        rigid = fields.equal and math.isinf(chain.actuator_stiffness)
        if not rigid or fewest_strokes(fields, "0" * len(chain), start).blocked is not None:
            return None
    plan = fewest_strokes(fields, start, target)
    if plan.blocked is not None and robust is not None:
        return None
    # Under a prescribed force relays are what the cells are.
    order = Order(True, True) if by_force else order_kept(chain, fields)
    if plan.blocked is not None:
        if not order.only_ideals:
            return None
        why = _why_blocked(chain, fields, plan.blocked)
        raise Unreachable(f"no program leads from {start} to {target}: {why}", proved=True)
    aimed = _aimed(branches, origin, plan.states, past=robust is not None)
    if aimed is None:
        return None
    method = ProgramMethod.RELAYS if chain.elements else ProgramMethod.FIELDS
    method = method if robust is None else ProgramMethod.VERTICES
    found = chain, start, target, origin[1], *aimed, method, order.leaders_win, origin[0]
    return Program(*found, robust)


def _why_blocked(chain: Chain, fields: Relays, blocked: tuple[int, int]) -> str:
    i, j = (chain.names[fields.cell[m]] for m in blocked)
    k, m = (fields.step[m] + 1 for m in blocked)
    smaller, beyond = "the smaller F0 and the smaller F1", ""
    if chain.elements:
        smaller = f"the smaller {chain.measure.force} up and the smaller one down"
        beyond = " or beyond"
    return (
        f"{i} has {smaller} of the two, so it {_goes_first(chain, fields, blocked)}. Where {j} is "
        f"at {m}{beyond}, {i} is at {k}{beyond}, unless they were set by hand (theory "
        f"page, 'Stroke programs')."
    )


def _aimed(
    branches: Branches,
    origin: tuple[Configuration, float],
    states: tuple[str, ...],
    *,
    past: bool = False,
) -> tuple[tuple[Turn, ...], float, float] | None:
    """Windows for turning at each of these states in turn; None where one is not on the way.

    With `past` they begin at the state and not after the snap before it.
    """
    place, drive = origin
    turns: list[Turn] = []
    low = high = drive
    for state in states:
        now = state_of(branches.chain.stretches, place)
        rises = sum(map(int, state)) > sum(map(int, now))
        end = branches.range[1] if rises else branches.range[0]
        for passage in passages_of(path(branches.chain, [drive, end], start=place)):
            section = next((one for one in passage.sections if one.state == state), None)
            if section is not None:
                break
        else:
            return None
        begin = section if past else passage.sections[0]
        first, last = sorted((begin.drive[0], passage.sections[-1].drive[1]))
        low, high = sorted(section.drive)
        vertices = tuple(p.state for p in passage.sections if "-" not in p.state)
        turns.append(Turn((first + last) / 2, first, last, vertices))
        place, drive = section.place[0], section.drive[0]
    return tuple(turns[:-1]), low, high


@dataclass(frozen=True)
class _Reached:
    """Where a search has come to: on a branch, moving in a direction, having turned so often."""

    branch: int
    direction: int
    entry: float
    turns: tuple[Turn, ...]
    can_turn: bool

    @property
    def cost(self) -> tuple[int, float]:
        """Few turns first, then wide windows."""
        return len(self.turns), -min((turn.slack for turn in self.turns), default=math.inf)


def _by_branches(
    branches: Branches,
    start: str,
    target: str,
    origin: tuple[Configuration, float],
    progress: Progress | None,
    robust: float | None,
) -> Program:
    first = branches.at(*origin)
    if start == target:
        here = branches[first].sections[branches[first].find(target, origin[1])]
        found = branches.chain, start, target, origin[1], (), *here.drive
        return Program(*found, ProgramMethod.BRANCHES, not branches.ties, origin[0], robust)
    order = count()
    heap: list[tuple[tuple[int, float], int, _Reached]] = []

    def push(reached: _Reached) -> None:
        heapq.heappush(heap, (reached.cost, next(order), reached))

    for direction in (+1, -1):
        push(_Reached(first, direction, origin[1], (), can_turn=False))
    seen: set[tuple[int, int, bool, int]] = set()
    looked: set[int] = set()
    while heap:
        _, _, reached = heapq.heappop(heap)
        entry = round(reached.entry / branches.slip)
        key = reached.branch, reached.direction, reached.can_turn, entry
        if key in seen:
            continue
        seen.add(key)
        looked.add(reached.branch)
        if progress is not None:
            progress(len(looked), len(branches))
        end = _end(branches, reached, target)
        if end is not None:
            found = branches.chain, start, target, origin[1], reached.turns, *end
            return Program(*found, ProgramMethod.BRANCHES, not branches.ties, origin[0], robust)
        if len(looked) > _MOST_BRANCHES:
            raise Unreachable(
                f"no program from {start} to {target} with {len(reached.turns)} turns or fewer, "
                f"and {_MOST_BRANCHES} branches were looked at: there may be a longer one.",
                proved=False,
            )
        if reached.can_turn:
            push(_turned(branches, reached))
        end_of = reached.branch, reached.direction
        exit_ = branches.exit(*end_of)
        if exit_ is not None and (robust is None or branches.landing(*end_of, robust).holds):
            push(replace(reached, branch=exit_.branch, entry=exit_.snap.drive[1], can_turn=True))
    states = sorted({v for number in looked for v in branches[number].vertices})
    raise Unreachable(
        f"no program leads from {start} to {target}: every branch that can be reached from {start} "
        f"({len(looked)} of them) was followed to both ends, and they hold {', '.join(states)} "
        f"only. {_why(branches, target)}".strip(),
        proved=not branches.ties,
    )


def _turned(branches: Branches, reached: _Reached) -> _Reached:
    """Where a search is after turning back on its branch."""
    branch = branches[reached.branch]
    low, high = (
        (reached.entry, branch.high) if reached.direction > 0 else (branch.low, reached.entry)
    )
    turn = Turn((low + high) / 2, low, high, branch.vertices)
    return replace(
        reached,
        direction=-reached.direction,
        entry=turn.drive,
        turns=(*reached.turns, turn),
        can_turn=False,
    )


def _end(branches: Branches, reached: _Reached, target: str) -> tuple[float, float] | None:
    """Drives at which a search may end in the state wanted, if that lies ahead on its branch."""
    for section in branches[reached.branch].sections:
        if section.state == target:
            low, high = section.drive
            if reached.direction > 0 and high >= reached.entry - branches.slip:
                return max(low, min(reached.entry, high)), high
            if reached.direction < 0 and low <= reached.entry + branches.slip:
                return low, min(high, max(reached.entry, low))
    return None


def _why(branches: Branches, target: str) -> str:
    """The order of fields that forbids a state, where there is one; or why nothing is proved."""
    if branches.ties:
        tie = next(iter(branches.ties))
        return f"That is no proof, since what happens hangs on a tie: {tie.advice}"
    chain = branches.chain
    fields = relays(chain)
    # What a stroke does to elements, their fields do not tell.
    told = not chain.elements or chain.actuator_stiffness == 0
    if fields is None or fields.skips or not told:
        return ""
    blocked = fewest_strokes(fields, chain.first_state, target).blocked
    if blocked is None:
        return ""
    return f"{chain.names[fields.cell[blocked[0]]]} {_goes_first(chain, fields, blocked)}."


def _goes_first(chain: Chain, fields: Relays, blocked: tuple[int, int]) -> str:
    """What the first of two relays does before and after the other."""
    (k, m), second = (fields.step[i] for i in blocked), chain.names[fields.cell[blocked[1]]]
    other = second if k == m else f"{second} goes to {m + 1}"
    return f"goes to {k + 1} before {other} and back to {k} after it"
