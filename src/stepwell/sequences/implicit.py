"""The transition graph of a chain with too many states to list, computed state by state."""

import math
from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from itertools import islice
from typing import Any

from stepwell import concave, mechanism, statics
from stepwell.base import ByValue, InputError, Progress, notify, require
from stepwell.sequences import passages, transition_graph
from stepwell.sequences.branches import Branches, Drive, checked_state, driven, refuse_friction
from stepwell.sequences.fields import Travels
from stepwell.sequences.nodes import Node, States, Transition, TransitionKind


class _ByBranches:
    """Nodes and transitions by branches; each branch is followed once and stored."""

    method = "each requested branch followed to both ends by the engine"
    # These are only counted by following every branch.
    transitions = gardens = sub_loops = None

    def __init__(self, chain: mechanism.Chain):
        self.chain = chain
        self._branches = Branches(chain)
        self._sections: dict[str, tuple[int, int]] = {}
        self._labels: dict[tuple[int, int], str] = {}
        self._sharing: Counter[str] = Counter()

    @property
    def ties(self) -> tuple[statics.Tie, ...]:
        return tuple(self._branches.ties)

    @cached_property
    def standing(self) -> int:
        windows = [[(p.force_low, p.force_high) for p in cell] for cell in self.chain.phases]
        return concave.standing_states(concave.levels(windows, 0.0))

    @cached_property
    def reached(self) -> int | None:
        fields = concave.relays(self.chain)
        if fields is None or not fields.equal or not math.isinf(self.chain.actuator_stiffness):
            return None
        if not passages.order_kept(self.chain, fields).only_ideals:
            return None
        return _count_or_none(concave.ideals, concave.levels(fields.windows, fields.slip))

    def node(self, label: str) -> Node:
        number, k = self._find(label)
        return transition_graph.node_of(label, self._branches[number].sections[k], number)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        way = transition_graph.way_on(self._branches, *self._find(label), direction)
        return None if way is None else (self._label(way[0]), way[1])

    def _find(self, label: str) -> tuple[int, int]:
        if label in self._sections:
            return self._sections[label]
        if "-" in label or "#" in label:
            raise InputError(
                f"state = {label!r}: is not visited yet: begin with a state in which every cell "
                f"is in a phase, such as {self.chain.first_state!r}, and walk."
            )
        place = self._branches.vertex(checked_state(self.chain, "state", label))
        if place is None:
            raise InputError(transition_graph.no_equilibrium(self.chain, "state", label))
        number = self._branches.at(*place)
        section = number, self._branches[number].find(label, place[1])
        self._label(section)
        return self._sections[label]

    def _label(self, section: tuple[int, int]) -> str:
        if section not in self._labels:
            number, k = section
            state = self._branches[number].sections[k].state
            self._sharing[state] += 1
            label = state if self._sharing[state] == 1 else f"{state}#{self._sharing[state]}"
            self._labels[section], self._sections[label] = label, section
        return self._labels[section]


def _count_or_none(count: Callable[[Any], int], levels: Any) -> int | None:
    known = concave.switches(levels)
    return None if known is None else count(known)


class _ByFields:
    """Windows of states and transitions by fields; every vertex is a branch of its own.

    Cells with equal fields switch together, independently of each other.
    """

    method = "switching fields: cells under a prescribed force do not interact"
    ties: tuple[statics.Tie, ...] = ()

    def __init__(self, chain: mechanism.Chain, fields: concave.Relays):
        self.chain = chain
        self._windows = fields.windows
        self._levels = concave.levels(self._windows, fields.slip)
        self._ways = {way: [concave.landings(c, way) for c in self._levels] for way in (+1, -1)}
        self._travels = Travels(chain)
        self._ends = Branches(chain).range
        self._states = States([len(cell) for cell in self._windows])

    @cached_property
    def standing(self) -> int:
        return concave.standing_states(self._levels)

    @property
    def transitions(self) -> int:
        # One up from every state but the last, one down from every one but the first.
        return 2 * self.standing - 2

    @cached_property
    def gardens(self) -> int:
        return concave.garden_states(self._levels)

    @cached_property
    def reached(self) -> int | None:
        return _count_or_none(concave.ideals, self._levels)

    @cached_property
    def sub_loops(self) -> int | None:
        return _count_or_none(concave.sub_loops, self._levels)

    def node(self, label: str) -> Node:
        phases = self._phases(label)
        own = [cell[k] for cell, k in zip(self._windows, phases, strict=True)]
        low = max(max(low for low, _ in own), self._ends[0])
        high = min(min(high for _, high in own), self._ends[1])
        begin, end = (self._travels.shown(phases, force)[1] for force in (low, high))
        number = self._states.code(label)
        assert number is not None
        return Node(label, label, low, high, low, high, begin, end, number)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        phases = self._phases(label)
        end, least = (1, min) if direction > 0 else (0, max)
        ends = [cell[k][end] for cell, k in zip(self._levels, phases, strict=True)]
        first, ways = least(ends), self._ways[direction]
        leave = tuple(i for i, at in enumerate(ends) if at == first and phases[i] in ways[i])
        if not leave:
            return None
        drives = [self._windows[i][phases[i]][end] for i in leave]
        after, heat = list(phases), []
        for i, force in zip(leave, drives, strict=True):
            after[i] = ways[i][phases[i]]
            heat.append(self._travels.heat((i, phases[i], after[i]), force))
        snap = TransitionKind.SNAP, direction, least(drives), leave, math.fsum(heat)
        return "".join(map(str, after)), Transition(*snap)

    def _phases(self, label: str) -> tuple[int, ...]:
        # The check that makes messages evaluates every curve of the chain.
        if self._states.code(label) is None:
            checked_state(self.chain, "state", label)
        phases = tuple(map(int, label))
        own = [cell[k] for cell, k in zip(self._levels, phases, strict=True)]
        if max(low for low, _ in own) > min(high for _, high in own):
            raise InputError(transition_graph.no_equilibrium(self.chain, "state", label))
        return phases


Way = tuple[str, Transition] | None


@dataclass(frozen=True, eq=False)
class Step(ByValue):
    """A node of a walk, with the next label and transition up and down, or None."""

    node: Node
    up: Way
    down: Way


@dataclass(frozen=True, eq=False)
class Walked(ByValue):
    """A walk from a node, see `ImplicitGraph.walk`; `whole` if it has all reachable nodes."""

    graph: "ImplicitGraph"
    start: str
    steps: tuple[Step, ...]
    whole: bool


@dataclass(frozen=True, eq=False)
class ImplicitGraph(ByValue):
    """A transition graph whose nodes and transitions are computed on demand.

    `node` and `transition` are those of a `TransitionGraph`. Under a prescribed force cells do not
    interact, so the order of their switching fields determines everything, counts included, for any
    number of cells. Otherwise, or if a cell is no relay, the engine follows each requested branch
    once and stores it.

    A label is a state, such as "010". If several nodes have one state, such as "0-1", those visited
    later are numbered: "0-1#2".

    Args:
        chain: the chain with its actuator; friction raises ValueError.

    Source: Preisach 1935; Terzi and Mungan 2020; some counts are ours (theory page,
    "Transition graphs", "Relays").
    """

    chain: mechanism.Chain

    def __post_init__(self):
        refuse_friction(self.chain)

    @cached_property
    def _ways(self) -> _ByFields | _ByBranches:
        # Under a force fields may tie: the order of two cells has no effect on the others.
        by_force = self.chain.actuator_stiffness == 0
        fields = concave.relays(self.chain, ties=True) if by_force else None
        return _ByBranches(self.chain) if fields is None else _ByFields(self.chain, fields)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the cells, inner first."""
        return self.chain.names

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.chain)

    @property
    def actuator(self) -> str:
        """Name of the actuator, as in `TransitionGraph.actuator`."""
        return str(transition_graph.about(self.chain)["actuator"])

    @property
    def unit(self) -> str:
        """Unit of drives: N under force control, m under others."""
        return self.chain.drive_unit

    @property
    def method(self) -> str:
        """Method that computes nodes and transitions."""
        return self._ways.method

    @property
    def ties(self) -> tuple[statics.Tie, ...]:
        """Degenerate events of the branches that were followed.

        Cells with equal fields under a force are no ties: they switch together, in any order.
        """
        return self._ways.ties

    @property
    def by_fields(self) -> bool:
        """Whether the order of fields determines the graph; else the engine follows branches."""
        return isinstance(self._ways, _ByFields)

    @property
    def is_listable(self) -> bool:
        """Whether the graph is small enough for `listed`."""
        return transition_graph.listable(self.chain)

    @property
    def zero(self) -> str:
        """Label of the node with every cell in its first phase, 0."""
        return self.chain.first_state

    @property
    def vertex_count(self) -> int:
        """Number of states with every cell in a phase that are stable at some drive."""
        return self._ways.standing

    @property
    def transition_count(self) -> int | None:
        """Number of transitions; None if that needs every branch to be followed."""
        return self._ways.transitions

    @property
    def reached_count(self) -> int | None:
        """Number of these vertices that are reachable from `zero`, itself included.

        None where it is unknown: if a cell can skip one of its phases, and under a stroke or a
        spring. The exception: for concave cells of one full travel and a rigid actuator a full
        cycle of the engine proves the count.
        """
        return self._ways.reached

    @property
    def garden_count(self) -> int | None:
        """Number of vertices without a predecessor, the Garden of Eden; None if unknown."""
        return self._ways.gardens

    @property
    def sub_loop_count(self) -> int | None:
        """Number of loops reachable from `zero`, without the main loop; None if unknown."""
        return self._ways.sub_loops

    def node(self, label: str) -> Node:
        """A node: its window of the drive, forces and travels.

        Under a force its branch is the number of its state among all, from 0, with the innermost
        cell as the first digit.

        Raises:
            ValueError: no state of the chain, no equilibrium, or in transit and not visited yet.
        """
        return self._ways.node(label)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the drive's rise (+1) or fall (-1) leads from a node; None where it ends.

        Raises:
            ValueError: as for `node`.
            StaticsError: a path cannot be computed; its text contains a possible action.
        """
        return self._ways.transition(label, direction)

    def up(self, label: str) -> tuple[str, Transition] | None:
        """Target and transition of the drive's rise from a node; None where it ends."""
        return self.transition(label, +1)

    def down(self, label: str) -> tuple[str, Transition] | None:
        """Target and transition of the drive's fall from a node; None where it ends."""
        return self.transition(label, -1)

    def stroke(self, label: str, direction: int) -> Iterator[tuple[str, Transition]]:
        """Nodes and transitions along the drive's rise (+1) or fall (-1).

        Up from `zero` and down again from the last node is the main loop. Raises as `transition`
        does.
        """
        while (way := self.transition(label, direction)) is not None:
            label = way[0]
            yield way

    def walked(
        self, start: str | None = None, *, most: int = 24, progress: Progress = None
    ) -> Walked:
        """The first nodes of `walk` with their transitions; `progress` gets (done, most)."""
        start = self.zero if start is None else start
        steps: list[Step] = []
        for node in self.walk(start, most=most):
            notify(progress, len(steps), most)
            steps.append(Step(node, self.up(node.label), self.down(node.label)))
        return Walked(self, start, tuple(steps), len(steps) < most)

    def walk(self, start: str | None = None, *, most: int = 1000) -> Iterator[Node]:
        """Reachable nodes, in the order of the number of transitions.

        Args:
            start: first label; all cells at 0 by default.
            most: largest number of nodes. If fewer are returned, they are all.

        Raises:
            ValueError: as for `node`, or more than the limit of nodes.
        """
        require("walked", most, "the walk may have")
        start = self.zero if start is None else start
        seen, waiting = {start}, deque([start])
        while waiting and most > 0:
            label = waiting.popleft()
            yield self.node(label)
            most -= 1
            for direction in (+1, -1) if len(waiting) < most else ():
                way = self.transition(label, direction)
                if way is not None and way[0] not in seen:
                    seen.add(way[0])
                    waiting.append(way[0])

    def listed(
        self, start: str | None = None, *, progress: Progress = None
    ) -> transition_graph.TransitionGraph:
        """The same graph listed. All else as for `Chain.graph`."""
        return transition_graph.graph(self.chain, start=start, progress=progress)

    def __repr__(self):
        return f"ImplicitGraph({self.cells} cells driven by {self.actuator})"

    @property
    def summary(self) -> str:
        """Size of the graph, in one line."""
        vertices = shown_count(self.vertex_count)
        return f"{self.cells} cells driven by {self.actuator}: {vertices} vertices, not listed"

    @property
    def facts(self) -> dict[str, str]:
        """Properties of the graph that are known without listing it, by name."""
        counts = {
            "transitions": self.transition_count,
            "from all at 0": self.reached_count,
            "sub-loops": self.sub_loop_count,
            "Garden of Eden": self.garden_count,
        }
        known = {name: shown_count(count) for name, count in counts.items() if count is not None}
        if self.by_fields:
            up, down = self._order(self.zero, +1), self._order(self.chain.last_state, -1)
            known = {"main loop, up": up, "main loop, down": down} | known
            known |= {"return-point memory": "holds", "avalanches": "none"}
        lost = ", ".join(name for name, count in counts.items() if count is None)
        if lost:
            known["not counted"] = f"{lost}: needs every branch to be followed"
        return known

    def __str__(self):
        return "\n".join([self.summary, *(f"{k:<20} {text}" for k, text in self.facts.items())])

    def _order(self, label: str, direction: int) -> str:
        """Names of the cells that move first on a stroke from a node."""
        first = islice(self.stroke(label, direction), _SHOWN + 1)
        names = [self.names[i] for _, snap in first for i in snap.cells]
        return ", ".join([*names[:_SHOWN], *["..."] * (len(names) > _SHOWN)])


_SHOWN = 6  # cells of an order
# Longer numbers are shown by their first digits.
_DIGITS = 15


def shown_count(count: int) -> str:
    """Text of a number of states, in full or by its first digits and its power of ten."""
    return str(count) if count < 10**_DIGITS else f"{Decimal(count):.3e}".replace("e+", "e")


def implicit_graph(chain: mechanism.Chain, drive: Drive = None) -> ImplicitGraph:
    """The transition graph of a chain, not listed. All else as for `Chain.implicit_graph`."""
    return ImplicitGraph(driven(chain, drive))
