"""Chains as state machines: what every input of a stroke program does, and a search for inputs."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Ints, amount, display_unit, number
from stepwell.mechanism import Chain
from stepwell.sequences.machines import Machine
from stepwell.sequences.mesostates import BranchAtlas, Routes, atlas
from stepwell.sequences.programs import Unreachable
from stepwell.sequences.transition_graph import graph
from stepwell.statics import Configuration, StaticsError

# Drives between ends of branches that are compared; more are thinned out.
_MOST_GAPS = 80
# Places closer than this at one drive are one [m].
_SAME = 1e-6
# Chains with more places at the base do not behave as a small machine.
_MOST_PLACES = 64
# Different inputs that are tried for each input of a machine.
_MOST_INPUTS = 400


class Span(NamedTuple):
    """A turning point and the interval in which it has the same effect [m, or N]."""

    drive: float
    low: float
    high: float

    @property
    def slack(self) -> float:
        """Largest deviation in both directions."""
        return min(self.drive - self.low, self.high - self.drive)


class Reply(NamedTuple):
    """A state of a chain at the base drive, and what every input does.

    Attributes:
        label: the state of the chain, such as "01"; - for a cell in transit.
        state: the state of the machine.
        output: its output.
        after: for each input the number of the next reply.
    """

    label: str
    state: str
    output: str
    after: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Realisation(ByValue):
    """A chain and a stroke program that behave as a state machine.

    Between two inputs the drive rests at `base`. Each input is a list of turning points, after
    which the drive returns to `base`. All intervals hold jointly.

    Attributes:
        chain, machine: the chain, and the machine it realises.
        base: the resting drive.
        inputs: turning points of each input, in the order of the machine's inputs.
        reset: turning points from all cells in their first phase to the base, both included; from
            a state that is set by hand, its drive and the base.
        start: the state of the chain at the base, or the one that is set by hand.
        by_hand: whether it can only be set by hand.
        replies: all states that the inputs reach, the first one first, with the effect of each
            input: exact, from the transition graph.
    """

    chain: Chain = field(repr=False)
    machine: Machine = field(repr=False)
    base: Span
    inputs: tuple[tuple[Span, ...], ...]
    reset: tuple[float, ...]
    start: str
    by_hand: bool
    replies: tuple[Reply, ...]

    @property
    def slack(self) -> float:
        """How far base and all turning points may deviate at once [m], or [N]."""
        return min(span.slack for span in (self.base, *(s for one in self.inputs for s in one)))

    def drives(self, inputs: Iterable[str]) -> tuple[float, ...]:
        """Turning points of a list of inputs, from the base to the base."""
        points = [self.base.drive]
        for name in inputs:
            turns = self.inputs[self.machine.inputs.index(name)]
            points += [*(span.drive for span in turns), self.base.drive]
        return tuple(points)

    def simulate(self, inputs: Sequence[str]) -> tuple[str, ...]:
        """Outputs by the engine: the one at the start first, then after each input.

        The engine follows each input once from each place at the base.
        """
        known, at = self._states, 0
        outputs = [self.machine.outputs[known.states[at]]]
        for name in inputs:
            at = known.after[at][self.machine.inputs.index(name)]
            outputs.append(self.machine.outputs[known.states[at]])
        return tuple(outputs)

    @cached_property
    def _states(self) -> "_Places":
        found = self._followed(self.chain)
        if found is None:
            raise InputError(
                "the chain does not behave as the machine: search its inputs again with "
                "`realisations`."
            )
        return found

    def _start_in(self, chain: Chain) -> Configuration:
        """The place of a chain at the base, after the reset."""
        reset = self.reset if len(self.reset) > 1 else (*self.reset, *self.reset)
        begin = self.start if self.by_hand else None
        return chain.path(list(reset), start=begin).end_configuration

    def _followed(self, chain: Chain) -> "_Places | None":
        """All places at the base that the inputs reach, by the engine; None for a mismatch."""
        known = _Places([self._start_in(chain)], [0], [])
        for k, place in enumerate(known.places):
            known.after.append(row := list[int]())
            for one, name in enumerate(self.machine.inputs):
                after = chain.path(list(self.drives([name])), start=place).end_configuration
                state = self.machine.moves[known.states[k]][one]
                at = known.find(after)
                row.append(len(known.places) if at is None else at)
                if at is None:
                    known.places.append(after)
                    known.states.append(state)
                elif known.states[at] != state:
                    return None
            if len(known.places) > _MOST_PLACES:
                return None
        return known

    def follow(self, inputs: Iterable[str]) -> tuple[str, ...]:
        """Outputs by the table of replies, the one at the start first."""
        at, outputs = 0, [self.replies[0].output]
        for name in inputs:
            at = self.replies[at].after[self.machine.inputs.index(name)]
            outputs.append(self.replies[at].output)
        return tuple(outputs)

    def holds_in(self, chain: Chain) -> bool:
        """Whether another chain, such as a sample within tolerances, behaves the same.

        It has the same base and turning points, and its own states. The engine follows every
        input from every place that the inputs reach.
        """
        try:
            return self._followed(chain) is not None
        except (StaticsError, ValueError):
            return False

    def __str__(self):
        unit, factor = display_unit(self.chain.drive_unit)

        def shown(span: Span) -> str:
            return f"{number(span.drive * factor)} (±{number(span.slack * factor)})"

        lines = [f"base {shown(self.base)} {unit}"]
        for name, spans in zip(self.machine.inputs, self.inputs, strict=True):
            lines.append(f"{name}: {' → '.join(map(shown, spans))} {unit}")
        points = " → ".join(number(drive * factor) for drive in self.reset)
        how = f"{self.start}, " + ("set by hand" if self.by_hand else f"by {points} {unit}")
        lines += [f"start: {how}", ""]
        head = ("chain", "state", "output", *self.machine.inputs)
        rows = [
            (one.label, one.state, one.output, *(self.replies[k].label for k in one.after))
            for one in self.replies
        ]
        widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
        for row in (head, *rows):
            cells = zip(row, widths, strict=True)
            lines.append("  ".join(f"{text:<{width}}" for text, width in cells).rstrip())
        return "\n".join(lines)

    def __repr__(self):
        slack = amount(self.slack, self.chain.drive_unit, 3)
        return f"Realisation({len(self.replies)} states, slack {slack})"


@dataclass
class _Places:
    """Places of a chain at the base, the machine's state in each, and the place after each input.

    States and places are numbers.
    """

    places: list[Configuration]
    states: list[int]
    after: list[list[int]]

    def find(self, place: Configuration) -> int | None:
        """The number of a place; None for a new one."""
        for k, known in enumerate(self.places):
            near = np.allclose(place.travel, known.travel, rtol=0.0, atol=_SAME)
            if near and place.sheet == known.sheet:
                return k
        return None


class _Response:
    """The branches of a chain by number, and what drives do to them."""

    def __init__(self, chain: Chain):
        self.chain = chain
        self.atlas: BranchAtlas = atlas(graph(chain))
        self.branches = self.atlas.mesostates
        self.routes = Routes(self.branches, self.atlas.bottom)

    def vertex_on(self, branch: int) -> tuple[str, float] | None:
        """A state with every cell in a phase on a branch, which a hand can set, and its drive."""
        nodes = self.atlas.graph.nodes
        for node in self.atlas.nodes_of(branch).tolist():
            if "-" not in nodes.label(node):
                return nodes.label(node).partition("#")[0], float(nodes.low[node])
        return None


class _Inputs(NamedTuple):
    """Different inputs at one base: what each does to every branch, and its turning points."""

    acts: Ints  # (I, B)
    gaps: list[tuple[int, ...]]  # numbers of gaps


def realisations(
    chain: Chain, machine: Machine, *, by_hand: bool = False, turns: int = 1
) -> Iterator[Realisation]:
    """Ways in which a chain realises a machine, one for each base drive and start.

    One drive between every two neighbouring ends of branches stands for all, so every program of
    inputs with up to `turns` turning points is tried, if a chain has up to 80 such gaps and up to
    400 inputs that differ in their effect at a base. More are thinned out, the widest kept.

    Args:
        chain: a chain without friction.
        machine: the machine; the smallest equivalent one is realised.
        by_hand: also begin in states that can only be set by hand.
        turns: most turning points of an input, 1 or 2.
    """
    machine, response = machine.smallest, _Response(chain)
    everywhere = np.arange(len(response.branches))
    among = everywhere if by_hand else np.flatnonzero(response.routes.reached)
    gaps = _gaps(response, among)
    middles = gaps.mean(axis=1)
    every = np.broadcast_to(everywhere, (len(gaps), len(everywhere)))
    moves = (
        response.branches.toward(-1).risen(every, -middles[:, None]),
        response.branches.risen(every, middles[:, None]),
    )
    for base in range(len(gaps)):
        stands = [
            int(b)
            for b in among
            if response.branches.low[b] <= middles[base] <= response.branches.high[b]
        ]
        if len(stands) < len(machine.states):
            continue
        inputs = _inputs_at(moves, base, np.array(stands), turns, gaps)
        for start in stands:
            chosen = _assigned(machine, inputs, start)
            if chosen is not None:
                one = _realised(response, machine, gaps, moves, (base, start, *chosen))
                if one is not None:
                    yield one


def realise(chain: Chain, machine: Machine, *, turns: int = 2) -> Realisation:
    """The realisation with the widest intervals; its start is set by hand only if necessary.

    All else as for `realisations`.

    Raises:
        Unreachable: there is none with that many turning points an input. This is proved if a word
            acts otherwise when it is repeated and the force is prescribed, or if its period is
            even and no program of the chain exchanges two states.
    """
    for by_hand in (False, True):
        ways = realisations(chain, machine, by_hand=by_hand, turns=turns)
        best = max(ways, key=lambda one: one.slack, default=None)
        if best is not None:
            return best
    why, proved = _no_realisation(chain, machine, turns)
    failure = Unreachable(f"{machine.title or 'the machine'}: {why}", proved=proved)
    failure.chain, failure.start = chain, chain.first_state
    failure.target = machine.title or "a machine"
    raise failure


def _no_realisation(chain: Chain, machine: Machine, turns: int) -> tuple[str, bool]:
    """Reason why a chain realises no machine, and whether it is a proof."""
    pump = machine.pump
    if chain.actuator_stiffness == 0 and pump is not None and not chain.elements:
        return (
            f"{pump}. Under a prescribed force, without friction, every word acts twice as it acts "
            f"once (theory page, 'State machines'): prescribe the stroke.",
            True,
        )
    if (
        pump is not None
        and pump.period % 2 == 0
        and exchanging_program(chain, by_hand=True) is None
    ):
        return (
            f"{pump}. No program exchanges two states of this chain, and such a word needs it "
            f"(theory page, 'State machines'): use another machine.",
            True,
        )
    return (
        f"no inputs with up to {turns} turning points were found on this chain. That is no proof "
        f"for longer inputs: use another chain, or sw.design.design_machine.",
        False,
    )


def _gaps(response: _Response, among: Ints) -> Floats:
    """(L, 2) drives between neighbouring ends of these branches."""
    branches = response.branches
    ends = np.unique(np.concatenate([branches.low[among], branches.high[among]]))
    gaps = np.column_stack([ends[:-1], ends[1:]])[np.diff(ends) > 4 * branches.slip]
    if len(gaps) > _MOST_GAPS:
        widest = np.sort(np.argsort(-np.ptp(gaps, axis=1), kind="stable")[:_MOST_GAPS])
        gaps = gaps[widest]
    return gaps


def _act(moves: tuple[Ints, Ints], base: int, turns: Sequence[int]) -> Ints:
    """(B,) the branch at the base after these turns, for each branch at the base."""
    at, before = np.arange(moves[0].shape[1]), base
    for gap in (*turns, base):
        if gap != before:
            at = moves[int(gap > before)][gap][at]
        before = gap
    return at


def _inputs_at(
    moves: tuple[Ints, Ints], base: int, stands: Ints, turns: int, gaps: Floats
) -> _Inputs:
    """Inputs that differ in what they do to the branches that exist at a base."""
    others = [gap for gap in range(len(gaps)) if gap != base]
    every: list[tuple[int, ...]] = [(gap,) for gap in others]
    if turns > 1:
        every += [(a, b) for a, b in product(others, others) if a != b]
    width = np.ptp(gaps, axis=1)
    best: dict[bytes, tuple[float, tuple[int, ...], Ints]] = {}
    for one in every:
        act = _act(moves, base, one)
        key, narrow = act[stands].tobytes(), float(min(width[gap] for gap in one))
        shorter = -len(one)
        if key not in best or (shorter, narrow) > (-len(best[key][1]), best[key][0]):
            best[key] = narrow, one, act
    kept = sorted(best.values(), key=lambda it: (len(it[1]), -it[0]))[:_MOST_INPUTS]
    acts = np.array([act for _, _, act in kept]).reshape(len(kept), -1)
    return _Inputs(acts, [one for _, one, _ in kept])


def _assigned(
    machine: Machine, inputs: _Inputs, start: int
) -> tuple[tuple[tuple[int, ...], ...], dict[int, int]] | None:
    """Turning points of each input such that states are those of the machine; None for none."""
    acts = inputs.acts.tolist()

    def closed(chosen: list[int]) -> dict[int, int] | None:
        known, waiting = {start: 0}, [start]
        for at in waiting:
            for k, number_of in enumerate(chosen):
                after, state = acts[number_of][at], machine.moves[known[at]][k]
                if after not in known:
                    known[after] = state
                    waiting.append(after)
                elif known[after] != state:
                    return None
        return known

    def grow(chosen: list[int]) -> list[int] | None:
        if len(chosen) == len(machine.inputs):
            return chosen
        for one in range(len(acts)):
            more = [*chosen, one]
            if one not in chosen and closed(more) is not None:
                whole = grow(more)
                if whole is not None:
                    return whole
        return None

    chosen = grow([])
    if chosen is None:
        return None
    known = closed(chosen)
    assert known is not None
    return tuple(inputs.gaps[one] for one in chosen), known


def _span(gaps: Floats, first: int, last: int) -> Span:
    low, high = float(gaps[first, 0]), float(gaps[last, 1])
    return Span((low + high) / 2, low, high)


def _realised(
    response: _Response,
    machine: Machine,
    gaps: Floats,
    moves: tuple[Ints, Ints],
    found: tuple[int, int, tuple[tuple[int, ...], ...], dict[int, int]],
) -> Realisation | None:
    """The realisation with all intervals widened; None where one label has two outputs."""
    base, start, chosen, known = found
    states = np.array([*known])
    windows = [_widened(moves, base, one, states, gaps) for one in chosen]
    middle = float(gaps[base].mean())
    number_of = {branch: k for k, branch in enumerate(known)}
    labels = {branch: response.atlas.label_at(branch, middle) for branch in known}
    outputs = {branch: machine.outputs[state] for branch, state in known.items()}
    if len({(labels[b], outputs[b]) for b in known}) > len({*labels.values()}):
        return None
    acts = [_act(moves, base, one) for one in chosen]
    replies = tuple(
        Reply(
            labels[branch],
            machine.states[state],
            outputs[branch],
            tuple(number_of[int(act[branch])] for act in acts),
        )
        for branch, state in known.items()
    )
    hand = not response.routes.reached[start]
    label = response.vertex_on(start) if hand else (labels[start], middle)
    if label is None:
        return None
    reset = (label[1], middle) if hand else response.routes.turns(start, middle)
    return Realisation(
        response.chain,
        machine,
        Span(middle, float(gaps[base, 0]), float(gaps[base, 1])),
        tuple(tuple(_span(gaps, a, b) for a, b in one) for one in windows),
        reset,
        label[0],
        hand,
        replies,
    )


def _widened(
    moves: tuple[Ints, Ints], base: int, turns: Sequence[int], states: Ints, gaps: Floats
) -> list[tuple[int, int]]:
    """For each turn the first and last gap such that all choices between do the same to states."""
    right = _act(moves, base, turns)[states]
    spans = [(gap, gap) for gap in turns]

    def same(spans: list[tuple[int, int]]) -> bool:
        ranges = [range(a, b + 1) for a, b in spans]
        return all(
            base not in one and np.array_equal(_act(moves, base, one)[states], right)
            for one in product(*ranges)
        )

    for k in range(len(spans)):
        for end, step in ((0, -1), (1, +1)):
            while True:
                a, b = spans[k]
                wider = [*spans]
                wider[k] = (a + step, b) if end == 0 else (a, b + step)
                beside = wider[k][end] if end == 0 else wider[k][1]
                if not 0 <= beside < len(gaps) or not _touch(gaps, wider[k]) or not same(wider):
                    break
                spans = wider
    return spans


def _touch(gaps: Floats, span: tuple[int, int]) -> bool:
    """Whether gaps follow each other with less than a tenth of a micrometre between them."""
    a, b = span
    return bool(np.all(gaps[a + 1 : b + 1, 0] - gaps[a:b, 1] < 1e-7))


class Exchange(NamedTuple):
    """Two states of a chain at one drive that a program brings into each other.

    Attributes:
        drive: the drive at its beginning and end [m, or N].
        first, second: their labels.
    """

    drive: float
    first: str
    second: str


def exchanging_program(chain: Chain, *, by_hand: bool = False) -> Exchange | None:
    """Two states that one program, of any turning points, brings into each other; None for none.

    A chain without such a pair realises no machine in which a word comes back to its state after
    an even number of repetitions and not before, such as a parity: half of these repetitions would
    exchange two states. All programs are followed, from both states at once.

    Args:
        chain: a chain without friction, with up to 80 gaps between ends of branches.
        by_hand: whether a hand may set any state.
    """
    response = _Response(chain)
    among = (
        np.arange(len(response.branches)) if by_hand else np.flatnonzero(response.routes.reached)
    )
    gaps = _gaps(response, among)
    middles = gaps.mean(axis=1)
    every = np.broadcast_to(np.arange(len(response.branches)), (len(gaps), len(response.branches)))
    falls = response.branches.toward(-1).risen(every, -middles[:, None]).tolist()
    rises = response.branches.risen(every, middles[:, None]).tolist()
    low, high = response.branches.low, response.branches.high
    for gap, middle in enumerate(middles.tolist()):
        stands = [int(b) for b in among if low[b] <= middle <= high[b]]
        for pair in combinations(stands, 2):
            if _exchanged((rises, falls), gap, pair):
                labels = (response.atlas.label_at(one, middle) for one in pair)
                return Exchange(middle, *labels)
    return None


def _exchanged(
    moves: tuple[list[list[int]], list[list[int]]], gap: int, pair: tuple[int, int]
) -> bool:
    """Whether some drives lead from a pair of branches at a gap to the pair in the other order."""
    seen, waiting = {(gap, *pair)}, [(gap, *pair)]
    for at, a, b in waiting:
        for step, table in ((1, moves[0]), (-1, moves[1])):
            if not 0 <= at + step < len(table):
                continue
            row = table[at + step]
            after = at + step, row[a], row[b]
            if after[1] != after[2] and after not in seen:
                seen.add(after)
                waiting.append(after)
    return (gap, *pair[::-1]) in seen
