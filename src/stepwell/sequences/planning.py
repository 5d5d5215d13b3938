"""Finding the shortest stroke program: by a theorem, by all branches, with friction by a search."""

import heapq
import math
from collections import deque
from dataclasses import dataclass, replace
from functools import partial
from itertools import count

from stepwell.base import InputError, Progress, amount, bisected, notify
from stepwell.concave import Relays, fewest_strokes, relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches, checked_state
from stepwell.sequences.passages import Order, SmoothRun, order_kept, passages_of, state_of
from stepwell.sequences.programs import Program, ProgramMethod, Turn, Unreachable
from stepwell.statics import Configuration, Landing, StaticsError, checked_ratio, path

_MOST_TURNS = 6
_MOST_PLACES = 4000
# Two places closer than this fraction of the ranges of travel and drive count as one.
_SAME = 1e-4


@dataclass(frozen=True)
class _Task:
    """Arguments of a search, and the place of the chain at the start."""

    branches: Branches
    start: str
    target: str
    place: Configuration
    drive: float
    progress: Progress
    robust: float | None = None

    def solved(
        self, turns: tuple[Turn, ...], ends: tuple[float, float], how: ProgramMethod, shortest: bool
    ) -> Program:
        """The program with these turns and drives at its end."""
        asked = self.branches.chain, self.start, self.target, self.drive
        return Program(*asked, turns, *ends, how, shortest, self.place, self.robust)


def _search_with_friction(task: _Task) -> Program:
    """First program with friction, in the order of the number of turns."""
    branches, chain = task.branches, task.branches.chain
    least, slip = _SAME * chain.full_stroke, _SAME * (branches.range[1] - branches.range[0])
    waiting: deque[tuple[Configuration, float, int, tuple[float, ...]]] = deque(
        (task.place, task.drive, direction, ()) for direction in (+1, -1)
    )
    seen: set[tuple[int, ...]] = set()
    while waiting and len(seen) < _MOST_PLACES:
        place, drive, direction, turns = waiting.popleft()
        travels = (round(s / least) for s in place.travel)
        key = (*travels, *place.sheet, round(drive / slip), direction)
        if key in seen:
            continue
        seen.add(key)
        notify(task.progress, len(seen), _MOST_PLACES)
        for section in _sections(chain, place, drive, branches.range[direction > 0]):
            if section.state == task.target:
                low, high = sorted(section.drive)
                program = _widened(task, turns, (low, high))
                if program is not None:
                    return program
            if len(turns) < _MOST_TURNS and section.drive[0] != section.drive[1]:
                middle = sum(section.drive) / 2
                stopped = path(chain, [drive, middle], start=place).end_configuration
                waiting.append((stopped, middle, -direction, (*turns, middle)))
    raise Unreachable(
        f"no program from {task.start} to {task.target} was found: {len(seen)} places with up to "
        f"{_MOST_TURNS} turns were tried, turning in the middle of every smooth part. With "
        f"friction this is no proof; without friction the result would be certain.",
        proved=False,
    )


def _sections(chain: Chain, place: Configuration, drive: float, end: float) -> list[SmoothRun]:
    try:
        passages = passages_of(path(chain, [drive, end], start=place))
        return [section for passage in passages for section in passage.sections]
    except (StaticsError, ValueError):
        # A place between two degenerate events: other places are near.
        return []


def _widened(task: _Task, turns: tuple[float, ...], ends: tuple[float, float]) -> Program | None:
    """The program, each window bisected with the other turns fixed.

    None where one of its landings depends on the mobilities.
    """
    chain, robust = task.branches.chain, task.robust
    points = [task.drive, *turns, sum(ends) / 2]

    def works(k: int, drive: float) -> bool:
        try:
            run = path(chain, [*points[:k], drive, *points[k + 1 :]], start=task.place)
        except (StaticsError, ValueError):
            return False
        arrives = state_of(chain.stretches, run.end_configuration) == task.target
        return arrives and (robust is None or all(x.holds for x in run.landings(robust)))

    if robust is not None and not works(0, points[0]):
        return None
    windows: list[Turn] = []
    for k in range(1, len(points) - 1):
        rises = points[k] > points[k - 1]
        inner = max(points[k - 1], points[k + 1]) if rises else min(points[k - 1], points[k + 1])
        outer = task.branches.range[rises]
        # The farthest drive towards each of the two at which the turn still works.
        low, high = sorted(
            far if works(k, far) else bisected(partial(works, k), points[k], far, 30)[0]
            for far in (inner, outer)
        )
        points[k] = (low + high) / 2
        windows.append(Turn(points[k], low, high, ()))
    return task.solved(tuple(windows), ends, ProgramMethod.FRICTION, False)


# Up to this number of cells every branch is followed; longer chains use sorted fields if possible.
_LOOKED_AT = 6
# Branches after which a search ends without a result.
_MOST_BRANCHES = 20_000


def program(
    chain: Chain,
    target: str,
    *,
    start: str | None = None,
    robust: float | None = None,
    progress: Progress = None,
) -> Program:
    """The shortest list of turning points of the actuator from one state to another.

    All else as for `Chain.program`.
    """
    start = checked_state(chain, "start", chain.first_state if start is None else start)
    checked_state(chain, "target", target)
    robust = None if robust is None else checked_ratio("robust", robust)
    try:
        return _planned(chain, start, target, robust, progress)
    except Unreachable as why:
        why.chain, why.start, why.target, why.robust = chain, start, target, robust
        raise


def _planned(
    chain: Chain, start: str, target: str, robust: float | None, progress: Progress
) -> Program:
    task = _task(chain, start, target, progress)
    rubbed = any(cell.friction > 0 for cell in chain.cells)
    search = _search_with_friction if rubbed else _search_branches
    program = _plan_by_relays(task) if not rubbed and len(chain) > _LOOKED_AT else None
    program = replace(program or search(task), robust=robust)
    landing = program.mobility_dependent_landing
    if landing is None:
        return program
    task = replace(task, robust=robust)
    turned = None if rubbed else _plan_by_relays(task)
    if turned is not None:
        return replace(turned, shortest=program.shortest and turned.strokes == program.strokes)
    try:
        return search(task)
    except Unreachable as why:
        text = _mobility_failure(program, landing) + ("" if why.proved else f" {_NO_PROOF}")
        raise Unreachable(text, proved=why.proved) from None


def _task(chain: Chain, start: str, target: str, progress: Progress = None) -> _Task:
    branches = Branches(chain)
    origin = branches.vertex(start)
    if origin is None:
        raise InputError(f"start: {_unstable(chain, start)}")
    if branches.vertex(target) is None:
        raise Unreachable(_unstable(chain, target), proved=True)
    return _Task(branches, start, target, *origin, progress)


_NO_PROOF = "That is no proof: not all ways could be looked at, or a tie stands in one."


def _mobility_failure(program: Program, landing: Landing) -> str:
    """Reason why no program holds for all mobilities within a ratio."""
    event, place = landing.event, landing.elsewhere[0]
    at = amount(event.drive, program.chain.drive_unit, 4)
    way = "loading" if event.direction > 0 else "unloading"
    cells = ", ".join(program.chain.names[cell] for cell in event.cells)
    factors = ", ".join(f"{one:.3g}" for one in place.mobility)
    return (
        f"no program from {program.start} to {program.target} has snaps that all land in one place "
        f"for mobility ratios up to {landing.ratio:g}. On the shortest program, {program}, the "
        f"snap at {at} while {way} ({cells}) fails: with {factors} times the given mobilities it "
        f"lands in {place.state}. Set a smaller ratio, choose another target state or change a "
        "cell."
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
        f"{giving} switches at {amount(gives, unit)} ({f0} and friction)."
    )


def _plan_by_relays(task: _Task) -> Program | None:
    """Program planned by relays, aimed by one run per stroke; None if it does not apply or fails.

    Under a prescribed stroke a `robust` program turns past vertices only: vertices do not depend on
    the mobilities, but the cell in transit before them does.

    Source: theory page, "Stroke programs" (a).
    """
    chain, robust = task.branches.chain, task.robust
    fields = relays(chain)
    if fields is None or fields.skips:
        return None
    by_force = chain.actuator_stiffness == 0
    if not by_force:
        rigid = fields.equal and math.isinf(chain.actuator_stiffness)
        if not rigid or fewest_strokes(fields, "0" * len(chain), task.start).blocked is not None:
            return None
    plan = fewest_strokes(fields, task.start, task.target)
    if plan.blocked is not None and robust is not None:
        return None
    # Under a prescribed force the cells are relays.
    order = Order(True, True) if by_force else order_kept(chain, fields)
    if plan.blocked is not None:
        if not order.only_ideals:
            return None
        why = _blocking_text(chain, fields, plan.blocked)
        text = f"no program leads from {task.start} to {task.target}: {why}"
        raise Unreachable(text, proved=True)
    aimed = _aimed_turns(task, plan.states)
    if aimed is None:
        return None
    method = ProgramMethod.RELAYS if chain.elements else ProgramMethod.FIELDS
    method = method if robust is None else ProgramMethod.VERTICES
    return task.solved(*aimed, method, order.leaders_win)


def _blocking_text(chain: Chain, fields: Relays, blocked: tuple[int, int]) -> str:
    i, j = (chain.names[fields.cell[m]] for m in blocked)
    k, m = (fields.step[m] + 1 for m in blocked)
    smaller, beyond = "the smaller F0 and the smaller F1", ""
    if chain.elements:
        smaller = f"the smaller {chain.measure.force} up and the smaller one down"
        beyond = " or beyond"
    return (
        f"{i} has {smaller} of the two, so it {_order_text(chain, fields, blocked)}. Where {j} is "
        f"at {m}{beyond}, {i} is at {k}{beyond}, unless they were set by hand (theory "
        f"page, 'Stroke programs')."
    )


def _aimed_turns(
    task: _Task, states: tuple[str, ...]
) -> tuple[tuple[Turn, ...], tuple[float, float]] | None:
    """Windows for turning at each of these states in turn; None where one is not on the way.

    For a robust program they begin at the state and not after the snap before it.
    """
    branches, place, drive = task.branches, task.place, task.drive
    turns: list[Turn] = []
    low = high = drive
    for state in states:
        now = state_of(branches.chain.stretches, place)
        rises = sum(map(int, state)) > sum(map(int, now))
        run = path(branches.chain, [drive, branches.range[rises]], start=place)
        for passage in passages_of(run):
            section = next((one for one in passage.sections if one.state == state), None)
            if section is not None:
                break
        else:
            return None
        begin = passage.sections[0] if task.robust is None else section
        first, last = sorted((begin.drive[0], passage.sections[-1].drive[1]))
        low, high = sorted(section.drive)
        vertices = tuple(p.state for p in passage.sections if "-" not in p.state)
        turns.append(Turn((first + last) / 2, first, last, vertices))
        place, drive = section.place[0], section.drive[0]
    return tuple(turns[:-1]), (low, high)


@dataclass(frozen=True)
class _Reached:
    """State of a search: branch, direction of the drive, and turns so far."""

    branch: int
    direction: int
    entry: float
    turns: tuple[Turn, ...]
    can_turn: bool

    @property
    def cost(self) -> tuple[int, float]:
        """Sort key: few turns first, then wide windows."""
        return len(self.turns), -min((turn.slack for turn in self.turns), default=math.inf)


def _search_branches(task: _Task) -> Program:
    branches, start, target = task.branches, task.start, task.target
    first = branches.at(task.place, task.drive)
    if start == target:
        here = branches[first].sections[branches[first].find(target, task.drive)]
        return task.solved((), here.drive, ProgramMethod.BRANCHES, not branches.ties)
    order = count()
    heap: list[tuple[tuple[int, float], int, _Reached]] = []

    def push(reached: _Reached) -> None:
        heapq.heappush(heap, (reached.cost, next(order), reached))

    for direction in (+1, -1):
        push(_Reached(first, direction, task.drive, (), can_turn=False))
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
        notify(task.progress, len(looked), len(branches))
        end = _end_interval(branches, reached, target)
        if end is not None:
            return task.solved(reached.turns, end, ProgramMethod.BRANCHES, not branches.ties)
        if len(looked) > _MOST_BRANCHES:
            raise Unreachable(
                f"no program from {start} to {target} with {len(reached.turns)} turns or fewer; "
                f"the limit of {_MOST_BRANCHES} branches is reached. A longer one may exist.",
                proved=False,
            )
        if reached.can_turn:
            push(_turned_back(branches, reached))
        end_of = reached.branch, reached.direction
        exit_, ratio = branches.exit(*end_of), task.robust
        if exit_ is not None and (ratio is None or branches.landing(*end_of, ratio).holds):
            push(replace(reached, branch=exit_.branch, entry=exit_.snap.drive[1], can_turn=True))
    states = sorted({v for number in looked for v in branches[number].vertices})
    raise Unreachable(
        f"no program leads from {start} to {target}: every branch that can be reached from {start} "
        f"({len(looked)} of them) was followed to both ends, and they hold {', '.join(states)} "
        f"only. {_field_order_text(branches, target)}".strip(),
        proved=not branches.ties,
    )


def _turned_back(branches: Branches, reached: _Reached) -> _Reached:
    """State of a search after turning back on its branch."""
    branch = branches[reached.branch]
    rises = reached.direction > 0
    low, high = (reached.entry, branch.high) if rises else (branch.low, reached.entry)
    turn = Turn((low + high) / 2, low, high, branch.vertices)
    turns = *reached.turns, turn
    return _Reached(reached.branch, -reached.direction, turn.drive, turns, can_turn=False)


def _end_interval(branches: Branches, reached: _Reached, target: str) -> tuple[float, float] | None:
    """Drives at which a search may end in the target state, if it lies ahead on its branch."""
    for section in branches[reached.branch].sections:
        if section.state == target:
            low, high = section.drive
            if reached.direction > 0 and high >= reached.entry - branches.slip:
                return max(low, min(reached.entry, high)), high
            if reached.direction < 0 and low <= reached.entry + branches.slip:
                return low, min(high, max(reached.entry, low))
    return None


def _field_order_text(branches: Branches, target: str) -> str:
    """Order of fields that excludes a state, if there is one; or the tie that prevents a proof."""
    tie = next(iter(branches.ties), None)
    if tie is not None:
        return f"This is no proof, because the result depends on a tie: {tie.advice}"
    chain = branches.chain
    fields = relays(chain)
    # Under a stroke the fields of elements do not decide the order.
    decided = not chain.elements or chain.actuator_stiffness == 0
    if fields is None or fields.skips or not decided:
        return ""
    blocked = fewest_strokes(fields, chain.first_state, target).blocked
    if blocked is None:
        return ""
    return f"{chain.names[fields.cell[blocked[0]]]} {_order_text(chain, fields, blocked)}."


def _order_text(chain: Chain, fields: Relays, blocked: tuple[int, int]) -> str:
    """Description of the moves of the first of two relays before and after the other."""
    (k, m), second = (fields.step[i] for i in blocked), chain.names[fields.cell[blocked[1]]]
    other = second if k == m else f"{second} goes to {m + 1}"
    return f"goes to {k + 1} before {other} and back to {k} after it"
