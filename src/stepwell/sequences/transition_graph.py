"""The transition graph of a chain driven by one actuator."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stepwell import base
from stepwell.base import Bools, ByValue, Drawn, Floats, InputError, Measure, amount, most, problem
from stepwell.concave import relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Branches, Drive, checked_state, driven, refuse_friction
from stepwell.sequences.nodes import Node, Nodes, Transition, TransitionKind
from stepwell.sequences.passages import SmoothRun, state_of
from stepwell.statics import Tie

if TYPE_CHECKING:
    import networkx as nx

    from stepwell.sequences.reading import MemoryReading

Numbers = NDArray[np.signedinteger[Any]]


@dataclass(frozen=True, eq=False)
class TransitionGraph(ByValue, Drawn):
    """Transition graph (t-graph): the stable states of a chain and the transitions between them.

    It iterates over the labels of its nodes: a state such as "010" with every cell in a phase, or
    one such as "0-1" with cells in transit. `graph.node(label)` is a Node, and
    `graph.transition(label, direction)` the transition by which the drive's rise or fall leaves it.
    Both are made from arrays on demand. Every node has one transition up and one down, except where
    the drive ends. The engine followed its branches, so it is exact for any cells without friction.

    Attributes:
        nodes: all nodes by number.
        target: (2, R) number of the node to which the drive's fall and its rise lead from each; -1
            where the drive ends.
        number: (2, R) number of that transition among `ways`; -1 likewise.
        ways: transitions; equal transitions are stored once.
        chain: the chain with its actuator; None where the graph was read from a file or made from
            switching fields.
        names: names of the cells, inner first.
        actuator: "stroke", "force" or the words of its measure, "spring of 53 N/m" or "field".
        unit: of drives: N under force control, m under others, "" for bare numbers.
        start: the state that it began with; None for all.
        method: method that computed it, in words.
        ties: degenerate events, with advice; empty if there are none.
        fields: the switching fields that it was made from; None for others.

    Source: Mungan and Terzi, 2019; van Hecke, 2021; nodes with strokes and cells in transit
    are ours (theory page, "Transition graphs").
    """

    nodes: Nodes = field(hash=False)
    target: Numbers
    number: Numbers
    ways: tuple[Transition, ...] = field(hash=False)
    chain: Chain | None
    names: tuple[str, ...]
    actuator: str
    unit: str
    start: str | None
    method: str
    ties: tuple[Tie, ...] = ()
    fields: Floats | None = None

    def __post_init__(self):
        for array in (self.target, self.number):
            array.setflags(write=False)

    @classmethod
    def of(
        cls, nodes: Sequence[Node], ways: Iterable[tuple[str, str, Transition]], **about: Any
    ) -> "TransitionGraph":
        """The graph of these nodes, and of transitions as (from, to, transition).

        A transition from or to no node, or a second one of a direction, raises ValueError.
        """
        held, every = Nodes(nodes), list(ways)
        target, number = np.full((2, len(held)), -1), np.full((2, len(held)), -1)
        for k, (a, b, transition) in enumerate(every):
            begin, end = held.find(a), held.find(b)
            if begin is None or end is None:
                raise InputError(f"edges[{k}]: leads from {a!r} to {b!r}; one of them is no node.")
            row = int(transition.direction > 0)
            if target[row, begin] >= 0:
                way = "rise" if row else "fall"
                raise InputError(f"edges[{k}]: the drive's {way} leads from {a!r} elsewhere too.")
            target[row, begin], number[row, begin] = end, k
        return cls(held, target, number, tuple(way for _, _, way in every), **about)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.names)

    @property
    def is_whole(self) -> bool:
        """Whether it contains every vertex, and not only those reachable from one."""
        return self.start is None

    @property
    def measure(self) -> Measure:
        """Kind of travel and force, by the unit of drives; bare numbers count as m."""
        return measure_of(self.unit)

    @cached_property
    def reading(self) -> "MemoryReading":
        """Memory properties: loops, return-point memory, scrambling, counting, latches."""
        from stepwell.sequences.reading import read_memory

        return read_memory(self)

    @cached_property
    def networkx(self) -> "nx.DiGraph[str]":
        """The graph as a frozen DiGraph of networkx.

        `.nodes[label]["node"]` is a Node, `.edges[a, b]["transitions"]` a tuple of Transition, one
        for each direction of the drive that leads from a to b.
        """
        import networkx as nx

        digraph: nx.DiGraph[str] = nx.DiGraph()
        digraph.add_nodes_from((node.label, {"node": node}) for node in self.nodes)
        for a, b, transition in self.transitions():
            before = digraph.edges[a, b]["transitions"] if digraph.has_edge(a, b) else ()
            digraph.add_edge(a, b, transitions=(*before, transition))
        return nx.freeze(digraph)

    def node(self, label: str) -> Node:
        """The node of that label; KeyError if there is none."""
        return self.nodes[self._find(label)]

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Target and transition of the drive's rise (+1) or fall (-1), or None; or KeyError."""
        at = int(direction > 0), self._find(label)
        number = int(self.number[at])
        return None if number < 0 else (self.nodes.label(int(self.target[at])), self.ways[number])

    def transitions(self) -> Iterator[tuple[str, str, Transition]]:
        """All (from, to, transition), for each node first of the rise, then of the fall."""
        labels = list(self)
        falls, rises = zip(self.target.tolist(), self.number.tolist(), strict=True)
        for a, *both in zip(labels, *rises, *falls, strict=True):
            for target, number in (both[:2], both[2:]):
                if number >= 0:
                    yield a, labels[target], self.ways[number]

    @property
    def transition_count(self) -> int:
        """Number of transitions."""
        return int(np.count_nonzero(self.number >= 0))

    @cached_property
    def snaps(self) -> Bools:
        """(2, R) whether the drive's fall and its rise from each node end in a snap."""
        kinds = [way.kind is TransitionKind.SNAP for way in self.ways]
        return np.array([*kinds, False])[self.number]

    @property
    def vertices(self) -> tuple[str, ...]:
        """Labels of the nodes with every cell in a phase, by the sum of their numbers."""
        return tuple(self.nodes.labels(self.nodes.vertices))

    @property
    def zero(self) -> str:
        """Label of the node with every cell in its first phase, 0.

        If slack cells share a motion, several nodes have that state; then the first.
        """
        state = "0" * self.cells
        return state if state in self else f"{state}#1"

    def reachable(self, start: str | None = None) -> frozenset[str]:
        """Labels of all nodes that are reachable from one node, by default from all-0."""
        number = self.nodes.find(self.zero if start is None else start)
        if number is None:
            return frozenset()
        seen = np.zeros(len(self), bool)
        front = np.array([number])
        while len(front):
            seen[front] = True
            after = self.target[:, front].ravel()
            after = after[after >= 0]
            front = np.unique(after[~seen[after]])
        return frozenset(self.nodes.labels(np.flatnonzero(seen)))

    def _find(self, label: str) -> int:
        number = self.nodes.find(label)
        if number is None:
            raise KeyError(label)
        return number

    def __len__(self) -> int:
        return len(self.nodes)

    def __iter__(self) -> Iterator[str]:
        return iter(self.nodes.labels(np.arange(len(self))))

    def __contains__(self, label: object) -> bool:
        return isinstance(label, str) and self.nodes.find(label) is not None

    def __repr__(self):
        return (
            f"TransitionGraph({self.cells} cells, {len(self.nodes.vertices)} vertices, "
            f"{len(self)} nodes, {np.count_nonzero(self.snaps)} snaps)"
        )


def measure_of(unit: str) -> Measure:
    """The measure that has this unit; travel and force for bare numbers."""
    units = {si: one for one in Measure for si in (one.travel_unit, one.force_unit)}
    return units.get(unit, Measure.TRAVEL)


def graph(
    chain: Chain, drive: Drive = None, *, start: str | None = None, progress: base.Progress = None
) -> TransitionGraph:
    """The transition graph of a chain. All else as for `Chain.graph`."""
    chain = driven(chain, drive)
    refuse_friction(chain)
    fields = relays(chain) if chain.actuator_stiffness == 0 else None
    if start is None:
        count, limit = _states(chain), "graph_cells" if fields is None else "relays"
        alike = _as_cells(count) == len(chain)
        require_as_many(count, limit, f"the chain has{'' if alike else ' as many states as'}")
    # With a start, every state has to have a number that an array can hold.
    if fields is not None and (start is None or _states(chain) < 1 << 62):
        from stepwell.sequences.fields import preisach

        return preisach(chain, fields, start)
    states = [range(int(last) + 1) for last in chain.last_state]
    branches = Branches(chain)
    starts = ["".join(map(str, one)) for one in product(*states)] if start is None else [start]
    first: list[int] = []
    for done, state in enumerate(starts):
        base.notify(progress, done, len(starts))
        place = branches.vertex(checked_state(chain, "start", state))
        if place is not None:
            first.append(branches.at(*place))
    if start is not None and not first:
        raise InputError(no_start(chain, start))
    reached = sorted(branches.all_from(first, progress))
    base.notify(progress, len(reached), len(reached))
    return _assembled(branches, reached, start)


def listable(chain: Chain) -> bool:
    """Whether the graph of a chain is small enough to be listed from every state."""
    limit = "relays" if chain.actuator_stiffness == 0 and relays(chain) else "graph_cells"
    return _as_cells(_states(chain)) <= most(limit)


def _states(chain: Chain) -> int:
    return math.prod(map(len, chain.stretches))


def _as_cells(count: int) -> int:
    """Number of bistable cells that have this number of states."""
    return (count - 1).bit_length()


def require_as_many(count: int, limit: str, what: str) -> None:
    """Raise InputError for more states than a limited number of bistable cells has."""
    cells = _as_cells(count)
    if cells > most(limit):
        raise InputError(
            f"{problem(limit, cells, what)} Or use chain.implicit_graph(), which counts states and "
            f"walks between them without listing them, pass start= to list the states reachable "
            f"from one state, or use chain.program(target=...) for one program."
        )


def no_start(chain: Chain, start: str) -> str:
    """Error text for a start that is no equilibrium."""
    why = no_equilibrium(chain, "start", start)
    return f"{why} Start from another state, or omit start to list all."


def no_equilibrium(chain: Chain, name: str, state: str) -> str:
    """Error text for a state that is no equilibrium."""
    why = "a cell at 1 pushes harder than one at 0 resists"
    if chain.elements:
        why = "no one force keeps every cell in its phase"
    return f"{name} = {state!r}: is no equilibrium: {why}."


def _assembled(branches: Branches, numbers: list[int], start: str | None) -> TransitionGraph:
    names, ties = _labels(branches, numbers), tuple(branches.ties)
    places = {number: place for place, number in enumerate(numbers)}
    nodes = [
        node_of(name, branches[number].sections[k], places[number])
        for (number, k), name in names.items()
    ]
    ways = [
        (name, names[way[0]], way[1])
        for section, name in names.items()
        for direction in (+1, -1)
        if (way := way_on(branches, *section, direction)) is not None
    ]
    chain, method = branches.chain, "every branch followed to both ends by the engine"
    return TransitionGraph.of(nodes, ways, **about(chain), ties=ties, start=start, method=method)


def node_of(label: str, section: SmoothRun, branch: int) -> Node:
    """A section of a branch as a node."""
    low, high = (place.travel for place in section.place)
    return Node(label, section.state, *section.drive, *section.force, low, high, branch)


def way_on(
    branches: Branches, number: int, k: int, direction: int
) -> tuple[tuple[int, int], Transition] | None:
    """Target (branch, section) and transition of the drive from section k of a branch, or None."""
    sections = branches[number].sections
    neighbour = k + direction
    if 0 <= neighbour < len(sections):
        states = zip(sections[k].state, sections[neighbour].state, strict=True)
        cells = tuple(i for i, (here, there) in enumerate(states) if here != there)
        at = sections[min(k, neighbour)].drive[1]
        return (number, neighbour), Transition(TransitionKind.SWITCH, direction, at, cells)
    exit_ = branches.exit(number, direction)
    if exit_ is None:
        return None
    snap, at = exit_.snap, exit_.snap.drive[0]
    onto = branches[exit_.branch]
    target = onto.find(state_of(branches.chain.stretches, exit_.place), at)
    before, after = sections[k].state, onto.sections[target].state
    # Without cells that only move within their phase.
    cells = tuple(
        cell
        for cell, a, b in zip(snap.cells, snap.before, snap.after, strict=True)
        if a == b or before[cell] != after[cell] or after[cell] == "-"
    )
    what = TransitionKind.SNAP, direction, at, cells, snap.released, snap.tie
    return (exit_.branch, target), Transition(*what)


def about(chain: Chain) -> dict[str, Any]:
    """Attributes of a graph that describe its chain."""
    stiffness, measure = chain.actuator_stiffness, chain.measure
    spring = f"spring of {amount(stiffness, measure.stiffness_unit, 6)}"
    actuator = {0.0: measure.force, math.inf: measure.stroke}.get(stiffness, spring)
    return {"chain": chain, "names": chain.names, "actuator": actuator, "unit": chain.drive_unit}


def _labels(branches: Branches, numbers: list[int]) -> dict[tuple[int, int], str]:
    """Labels of the sections: the state, numbered by rising drive where several have it."""
    places: dict[str, list[tuple[float, int, int]]] = {}
    for number in numbers:
        for k, section in enumerate(branches[number].sections):
            places.setdefault(section.state, []).append((section.drive[0], number, k))
    labels: dict[tuple[int, int], str] = {}
    for state, sharing in places.items():
        for count, (_, number, k) in enumerate(sorted(sharing), 1):
            labels[number, k] = state if len(sharing) == 1 else f"{state}#{count}"
    return dict(sorted(labels.items()))
