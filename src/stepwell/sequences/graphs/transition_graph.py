"""The transition graph: everything that one actuator can do to a chain."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import networkx as nx

from stepwell.base import Drawn, InputError, Measure, Shown, amount, most, problem, same
from stepwell.concave import relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import (
    Branches,
    Drive,
    Section,
    checked_state,
    driven,
    refuse_friction,
    state_of,
)
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.statics import Segment, Tie

if TYPE_CHECKING:
    from stepwell.sequences.memory import MemoryReading


class TransitionGraph(nx.DiGraph, Shown, Drawn):
    """Where a chain can stand, and how it gets from there to elsewhere.

    A networkx DiGraph, frozen. Its keys are labels: a state such as "010" with every cell in a
    phase, or one such as "0-1" with cells in transit. `graph.nodes[label]["node"]` is a Node,
    `graph.edges[a, b]["transitions"]` a tuple of Transition, one for each direction of the
    drive that leads from a to b.

    Every node has one way up and one way down, except where the drive ends. Its branches are
    what the engine followed, so the graph is exact for any cells without friction.

    Source: Mungan and Terzi, 2019; van Hecke, 2021; nodes with strokes and cells in transit
    are ours (theory page, "Transition graphs").
    """

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or all(
            same(getattr(self, part), getattr(other, part)) for part in ("graph", "_node", "_adj")
        )

    # A DiGraph can be changed, so it is no key.
    __hash__ = None  # type: ignore[assignment]

    @property
    def chain(self) -> Chain | None:
        """What it is the graph of, with the actuator that drives it.

        None where the graph was read from a file or made from switching fields.
        """
        return self.graph["chain"]

    @property
    def names(self) -> tuple[str, ...]:
        """What each cell is called, inner first."""
        return self.graph["names"]

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return len(self.names)

    @property
    def actuator(self) -> str:
        """What drives it: "stroke", "force", "spring of 53 N/m" or "field".

        Chains of volume and pressure, or of angle and torque, are driven by these.
        """
        return self.graph["actuator"]

    @property
    def ties(self) -> tuple[Tie, ...]:
        """Where the model cannot tell two outcomes apart, with advice; empty if nowhere."""
        return self.graph["ties"]

    @property
    def method(self) -> str:
        """How it was found, in words."""
        return self.graph["method"]

    @property
    def is_whole(self) -> bool:
        """Whether it began with every vertex, not only with one."""
        return self.graph["start"] is None

    @property
    def unit(self) -> str:
        """Unit of drives: N under force control, m under others, "" for bare numbers."""
        return self.graph["unit"]

    @property
    def measure(self) -> Measure:
        """What travel and force are in it, as the unit of drives tells; bare numbers are of m."""
        return measure_of(self.unit)

    @cached_property
    def reading(self) -> MemoryReading:
        """The graph in the words of the field: loops, memory, scrambling, counting, latches."""
        from stepwell.sequences.memory import read_memory

        return read_memory(self)

    def node(self, label: str) -> Node:
        """The node of that label."""
        return self.nodes[label]["node"]

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the drive's rise (+1) or fall (-1) leads from a node; None where it ends."""
        for _, target, transitions in self.out_edges(label, data="transitions"):
            for transition in transitions:
                if transition.direction == direction:
                    return target, transition
        return None

    @property
    def vertices(self) -> tuple[str, ...]:
        """Labels of the nodes with every cell in a phase, by the sum of their numbers."""
        found = [label for label in self if "-" not in label]
        return tuple(sorted(found, key=lambda label: (self.node(label).level, label[::-1])))

    @property
    def zero(self) -> str:
        """Label of the node with every cell in its first phase, 0.

        Several nodes share that state only where slack cells share a motion; then the first.
        """
        state = "0" * self.cells
        return state if state in self else f"{state}#1"

    def reachable(self, start: str | None = None) -> frozenset[str]:
        """Labels of all nodes that the actuator can bring the chain to from a node.

        Args:
            start: its label; all cells at 0 by default.
        """
        start = self.zero if start is None else start
        if start not in self:
            return frozenset()
        return frozenset(nx.descendants(self, start) | {start})

    def __str__(self):
        return repr(self)

    def __repr__(self):
        snaps = sum(t.kind is TransitionKind.SNAP for _, _, t in transitions(self))
        return (
            f"TransitionGraph({self.cells} cells, {len(self.vertices)} vertices, "
            f"{len(self)} nodes, {snaps} snaps)"
        )


def measure_of(unit: str) -> Measure:
    """The measure one of whose units this is; that of travel and force for bare numbers."""
    units = {si: one for one in Measure for si in (one.travel_unit, one.force_unit)}
    return units.get(unit, Measure.TRAVEL)


def transitions(graph: TransitionGraph) -> Iterator[tuple[str, str, Transition]]:
    """Every (from, to, transition)."""
    for a, b, together in graph.edges(data="transitions"):
        for transition in together:
            yield a, b, transition


def graph(
    chain: Chain,
    drive: Drive = None,
    *,
    start: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> TransitionGraph:
    """The transition graph of a chain. All else as for `Chain.graph`."""
    chain = driven(chain, drive)
    refuse_friction(chain)
    fields = relays(chain) if chain.actuator_stiffness == 0 else None
    if start is None:
        _require_listable(chain, "graph_cells" if fields is None else "relays")
    if fields is not None and start is None:
        from stepwell.sequences.graphs.fields import preisach

        return preisach(chain, fields)
    branches = Branches(chain)
    states = [range(int(last) + 1) for last in chain.last_state]
    branches = Branches(chain)
    starts = ["".join(map(str, one)) for one in product(*states)] if start is None else [start]
    first: list[int] = []
    for done, state in enumerate(starts):
        if progress is not None:
            progress(done, len(starts))
        place = branches.vertex(checked_state(chain, "start", state))
        if place is not None:
            first.append(branches.at(*place))
        elif start is not None:
            raise InputError(
                f"start = {start!r}: is no equilibrium: {overdrawn(chain)}. Start from another "
                f"state, or leave start out to see all."
            )
    found = sorted(branches.all_from(first, progress))
    if progress is not None:
        progress(len(found), len(found))
    return _assembled(branches, found, start)


def listable(chain: Chain) -> bool:
    """Whether the limits let the graph of a chain be listed from every state."""
    limit = "relays" if chain.actuator_stiffness == 0 and relays(chain) else "graph_cells"
    return _as_cells(chain) <= most(limit)


def _as_cells(chain: Chain) -> int:
    """How many cells of two phases have as many states."""
    return (math.prod(map(len, chain.stretches)) - 1).bit_length()


def _require_listable(chain: Chain, limit: str) -> None:
    cells = _as_cells(chain)
    if cells > most(limit):
        what = "the chain has" if cells == len(chain) else "the chain has as many states as"
        raise InputError(
            f"{problem(limit, cells, what)} Or ask chain.implicit_graph(), which counts states and "
            f"walks from one to the next without listing them, pass start= to list what can be "
            f"reached from one state, or ask chain.program(to=...) for one way."
        )


def overdrawn(chain: Chain) -> str:
    """Why a state is no equilibrium."""
    if chain.elements:
        return "no one force keeps every cell in its phase"
    return "a cell at 1 pushes harder than one at 0 holds"


def _assembled(branches: Branches, numbers: list[int], start: str | None) -> TransitionGraph:
    """The branches as a graph."""
    chain = branches.chain
    names = _labels(branches, numbers)
    found = TransitionGraph()
    for place, number in enumerate(numbers):
        for k, section in enumerate(branches[number].sections):
            label = names[number, k]
            found.add_node(label, node=node_of(label, section, place))
    for number in numbers:
        last = len(branches[number].sections) - 1
        inner = (end for k in range(last) for end in ((k, +1), (k + 1, -1)))
        for k, direction in (*inner, (last, +1), (0, -1)):
            way = way_on(branches, number, k, direction)
            if way is not None:
                target, transition = way
                join(found, names[number, k], names[target], transition)
    found.graph.update(
        **about(chain),
        ties=tuple(branches.ties),
        start=start,
        method="every branch followed to both ends by the engine",
    )
    return nx.freeze(found)


def node_of(label: str, section: Section, branch: int) -> Node:
    """A section of a branch as a node."""
    return Node(label, section.state, *section.drive, *section.force, *section.travel, branch)


def way_on(
    branches: Branches, number: int, k: int, direction: int
) -> tuple[tuple[int, int], Transition] | None:
    """Where the drive leads from a section of a branch; None where it ends.

    Args:
        branches: of a chain.
        number, k: of the branch, and of the section on it.
        direction: +1 where the drive rises, -1 where it falls.

    Returns:
        Numbers of branch and section, and what happens on the way there.
    """
    sections = branches[number].sections
    beside = k + direction
    if 0 <= beside < len(sections):
        cells = _unlike(sections[k].state, sections[beside].state)
        at = sections[min(k, beside)].drive[1]
        return (number, beside), Transition(TransitionKind.SWITCH, direction, at, cells)
    exit_ = branches.exit(number, direction)
    if exit_ is None:
        return None
    snap, at = exit_.snap, exit_.snap.drive[0]
    onto = branches[exit_.branch]
    target = onto.find(state_of(branches.chain.stretches, exit_.place), at)
    cells = _changed(snap, sections[k].state, onto.sections[target].state)
    what = TransitionKind.SNAP, direction, at, cells, snap.released, snap.tie
    return (exit_.branch, target), Transition(*what)


def about(chain: Chain) -> dict[str, object]:
    """What a graph says of the chain that it is of."""
    stiffness, measure = chain.actuator_stiffness, chain.measure
    spring = f"spring of {amount(stiffness, measure.stiffness_unit, 6)}"
    actuator = {0.0: measure.force, math.inf: measure.stroke}.get(stiffness, spring)
    return {"chain": chain, "names": chain.names, "actuator": actuator, "unit": chain.drive_unit}


def _labels(branches: Branches, numbers: list[int]) -> dict[tuple[int, int], str]:
    """A label for every section: its state, numbered by rising drive where several share it."""
    places: dict[str, list[tuple[float, int, int]]] = {}
    for number in numbers:
        for k, section in enumerate(branches[number].sections):
            places.setdefault(section.state, []).append((section.drive[0], number, k))
    labels: dict[tuple[int, int], str] = {}
    for state, sharing in places.items():
        for count, (_, number, k) in enumerate(sorted(sharing), 1):
            labels[number, k] = state if len(sharing) == 1 else f"{state}#{count}"
    return labels


def _changed(snap: Segment, before: str, after: str) -> tuple[int, ...]:
    """The cells of a snap but for those that only give way within the phase they are in."""
    moved = zip(snap.cells, snap.before, snap.after, strict=True)
    return tuple(
        cell for cell, a, b in moved if a == b or before[cell] != after[cell] or after[cell] == "-"
    )


def _unlike(a: str, b: str) -> tuple[int, ...]:
    return tuple(i for i, (x, y) in enumerate(zip(a, b, strict=True)) if x != y)


def join(found: TransitionGraph, a: str, b: str, transition: Transition) -> None:
    """Let a transition lead from a to b, beside those that do already."""
    before = found.edges[a, b]["transitions"] if found.has_edge(a, b) else ()
    found.add_edge(a, b, transitions=(*before, transition))
