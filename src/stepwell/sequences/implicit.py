"""The transition graph of a chain with too many states to be listed: asked state by state."""

import math
from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from itertools import islice

from stepwell import concave, mechanism, statics
from stepwell.base import ByValue, InputError, require
from stepwell.sequences import passages, transition_graph
from stepwell.sequences.branches import Branches, Drive, checked_state, driven, refuse_friction
from stepwell.sequences.fields import Travels, heat_of
from stepwell.sequences.nodes import Node, Transition, TransitionKind


class ByBranches:
    """Nodes and the ways between them; each branch is followed once and remembered.

    Args:
        chain: no friction.
    """

    method = "every branch that was asked for followed to both ends by the engine"
    # Nobody counts these but by following every branch.
    transitions = gardens = sub_loops = None

    def __init__(self, chain: mechanism.Chain):
        self.chain = chain
        self._branches = Branches(chain)
        self._sections: dict[str, tuple[int, int]] = {}
        self._labels: dict[tuple[int, int], str] = {}
        self._sharing: Counter[str] = Counter()

    @property
    def ties(self) -> tuple[statics.Tie, ...]:
        """Those on the branches that were followed."""
        return tuple(self._branches.ties)

    @cached_property
    def standing(self) -> int:
        """How many states stand with every cell in a phase, at one force."""
        windows = [[(p.force_low, p.force_high) for p in cell] for cell in self.chain.phases]
        return concave.standing_states(concave.levels(windows, 0.0))

    @cached_property
    def reached(self) -> int | None:
        """How many of these are reached from the first one, where one cycle proves it."""
        fields = concave.relays(self.chain)
        if fields is None or not fields.equal or not math.isinf(self.chain.actuator_stiffness):
            return None
        return _ideals(fields) if passages.order_kept(self.chain, fields).only_ideals else None

    def node(self, label: str) -> Node:
        """The node of that label."""
        number, k = self._find(label)
        return transition_graph.node_of(label, self._branches[number].sections[k], number)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the drive leads from a node."""
        way = transition_graph.way_on(self._branches, *self._find(label), direction)
        return None if way is None else (self._label(way[0]), way[1])

    def _find(self, label: str) -> tuple[int, int]:
        if label in self._sections:
            return self._sections[label]
        if "-" in label or "#" in label:
            raise InputError(
                f"state = {label!r}: has not been come to: begin with a state in which every cell "
                f"is in a phase, such as {self.chain.first_state!r}, and walk."
            )
        place = self._branches.vertex(checked_state(self.chain, "state", label))
        if place is None:
            raise InputError(
                f"state = {label!r}: is no equilibrium: {transition_graph.overdrawn(self.chain)}."
            )
        number = self._branches.at(*place)
        found = number, self._branches[number].find(label, place[1])
        self._label(found)
        return self._sections[label]

    def _label(self, section: tuple[int, int]) -> str:
        if section not in self._labels:
            number, k = section
            state = self._branches[number].sections[k].state
            self._sharing[state] += 1
            count = self._sharing[state]
            label = state if count == 1 else f"{state}#{count}"
            self._labels[section], self._sections[label] = label, section
        return self._labels[section]


def _ideals(fields: concave.Relays) -> int | None:
    known = concave.switches(concave.levels(fields.windows, fields.slip))
    return None if known is None else concave.ideals(known)


class ByFields:
    """Windows of states and ways between them; every vertex is a branch of its own.

    Cells whose fields tie leave together: each goes its own way at the same force.

    Args:
        chain: under force control.
        fields: of its cells.
    """

    method = "switching fields: cells under a prescribed force do not feel each other"
    ties: tuple[statics.Tie, ...] = ()

    def __init__(self, chain: mechanism.Chain, fields: concave.Relays):
        self.chain = chain
        self._windows = fields.windows
        self._levels = concave.levels(self._windows, fields.slip)
        self._ways = {
            way: [concave.landings(cell, way) for cell in self._levels] for way in (+1, -1)
        }
        self._travels = Travels(chain)
        self._ends = Branches(chain).range
        self._last = chain.last_state
        self._heat: dict[tuple[int, int, int], float] = {}

    @cached_property
    def standing(self) -> int:
        """How many states stand at some force."""
        return concave.standing_states(self._levels)

    @cached_property
    def transitions(self) -> int:
        """How many: one up from every state but the last, one down from every one but the first."""
        return 2 * self.standing - 2

    @cached_property
    def gardens(self) -> int:
        """How many states no other leads to."""
        return concave.garden_states(self._levels)

    @cached_property
    def reached(self) -> int | None:
        """How many states are reached from the first one; None where a cell passes a phase by."""
        relays = concave.switches(self._levels)
        return None if relays is None else concave.ideals(relays)

    @cached_property
    def sub_loops(self) -> int | None:
        """How many sub-loops are reached from the first state; None likewise."""
        relays = concave.switches(self._levels)
        return None if relays is None else concave.sub_loops(relays)

    def node(self, label: str) -> Node:
        """The state as a node."""
        phases = self._phases(label)
        own = [cell[k] for cell, k in zip(self._windows, phases, strict=True)]
        low = max(max(low for low, _ in own), self._ends[0])
        high = min(min(high for _, high in own), self._ends[1])
        begin, end = (
            tuple(self._travels.at(i, k, force) for i, k in enumerate(phases))
            for force in (low, high)
        )
        number = 0
        for cell, k in zip(self._windows, phases, strict=True):
            number = number * len(cell) + k
        return Node(label, label, low, high, low, high, begin, end, number)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the force leads from a state."""
        phases = self._phases(label)
        end = 1 if direction > 0 else 0
        ends = [cell[k][end] for cell, k in zip(self._levels, phases, strict=True)]
        first = min(ends) if direction > 0 else max(ends)
        ways = self._ways[direction]
        leave = tuple(i for i, at in enumerate(ends) if at == first and phases[i] in ways[i])
        if not leave:
            return None
        drives = [self._windows[i][phases[i]][end] for i in leave]
        after, heat = list(phases), []
        for i, force in zip(leave, drives, strict=True):
            after[i] = ways[i][phases[i]]
            heat.append(self._released(i, phases[i], after[i], force))
        drive = min(drives) if direction > 0 else max(drives)
        snap = Transition(TransitionKind.SNAP, direction, drive, leave, math.fsum(heat))
        return "".join(map(str, after)), snap

    def _phases(self, label: str) -> tuple[int, ...]:
        if not self._is_state(label):
            checked_state(self.chain, "state", label)
        phases = tuple(map(int, label))
        own = [cell[k] for cell, k in zip(self._levels, phases, strict=True)]
        if max(low for low, _ in own) > min(high for _, high in own):
            raise InputError(
                f"state = {label!r}: is no equilibrium: {transition_graph.overdrawn(self.chain)}."
            )
        return phases

    def _is_state(self, label: str) -> bool:
        # What checks a state for messages looks at every curve of the chain.
        digits = zip(label, self._last, strict=True)
        return len(label) == len(self._last) and all("0" <= a <= b for a, b in digits)

    def _released(self, cell: int, phase: int, target: int, force: float) -> float:
        key = cell, phase, target
        if key not in self._heat:
            self._heat[key] = heat_of(self.chain, self._travels, key, force)
        return self._heat[key]


Way = tuple[str, Transition] | None


@dataclass(frozen=True, eq=False)
class Step(ByValue):
    """A node of a walk, and where the drive's rise and fall lead from it.

    Attributes:
        node: where the walk is.
        up, down: the label of the next node and what happens; None where the way ends.
    """

    node: Node
    up: Way
    down: Way


@dataclass(frozen=True, eq=False)
class Walked(ByValue):
    """A walk through a graph that is not listed, see `ImplicitGraph.walk`.

    Attributes:
        graph: of any chain.
        start: label of the node with which it begins.
        steps: the nodes, those after fewest transitions first.
        whole: whether these are all nodes that can be reached.
    """

    graph: "ImplicitGraph"
    start: str
    steps: tuple[Step, ...]
    whole: bool


@dataclass(frozen=True, eq=False)
class ImplicitGraph(ByValue):
    """A transition graph of which only what is asked for is made.

    `node` and `transition` are those of a `TransitionGraph`. Under a prescribed force cells do not
    feel each other, so that the order of their switching fields tells all, counts included, for any
    number of cells. Otherwise, and where a cell is no relay, branches are followed by the engine
    when they are asked for, and remembered.

    A label is a state, such as "010"; of several nodes in one state, such as "0-1", those that are
    come to later are numbered: "0-1#2".

    Args:
        chain: with the actuator that drives it; no friction.

    Raises:
        ValueError: friction.

    Source: Preisach 1935; Terzi and Mungan 2020; the counts are ours where the theory page says so
    ("Transition graphs", "Relays").
    """

    chain: mechanism.Chain

    def __post_init__(self):
        refuse_friction(self.chain)

    @cached_property
    def _ways(self) -> ByFields | ByBranches:
        # Under a force fields may tie: no cell feels which of two goes first.
        by_force = self.chain.actuator_stiffness == 0
        fields = concave.relays(self.chain, ties=True) if by_force else None
        return ByBranches(self.chain) if fields is None else ByFields(self.chain, fields)

    @property
    def names(self) -> tuple[str, ...]:
        """What each cell is called, inner first."""
        return self.chain.names

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return len(self.chain)

    @property
    def actuator(self) -> str:
        """What drives it, as in `TransitionGraph.actuator`."""
        return str(transition_graph.about(self.chain)["actuator"])

    @property
    def unit(self) -> str:
        """Unit of drives: N under force control, m under others."""
        return self.chain.drive_unit

    @property
    def method(self) -> str:
        """How what it says is found, in words."""
        return self._ways.method

    @property
    def ties(self) -> tuple[statics.Tie, ...]:
        """Where the model cannot tell two outcomes apart, as far as branches were followed.

        Cells whose fields tie under a force are none: they leave together, and where they arrive no
        order tells.
        """
        return self._ways.ties

    @property
    def by_fields(self) -> bool:
        """Whether the order of fields tells all; if not, the engine follows branches."""
        return isinstance(self._ways, ByFields)

    @property
    def is_listable(self) -> bool:
        """Whether the limits let `listed` begin with every state."""
        return transition_graph.listable(self.chain)

    @property
    def zero(self) -> str:
        """Label of the node with every cell in its first phase, 0."""
        return self.chain.first_state

    @property
    def vertex_count(self) -> int:
        """How many states with every cell in a phase stand, at some drive."""
        return self._ways.standing

    @property
    def transition_count(self) -> int | None:
        """How many transitions there are; None where only following every branch would tell."""
        return self._ways.transitions

    @property
    def reached_count(self) -> int | None:
        """How many of these vertices can be reached from `zero`, itself included.

        None where that is not known: a cell that can pass a phase of its own by, and under a stroke
        or a spring all but concave cells of one full travel of which one full cycle of a rigid
        actuator proves it. That cycle is run by the engine when this is asked.
        """
        return self._ways.reached

    @property
    def garden_count(self) -> int | None:
        """How many vertices no other leads to, the Garden of Eden; None where it is not known."""
        return self._ways.gardens

    @property
    def sub_loop_count(self) -> int | None:
        """How many loops can be reached from `zero`, the main one left out; None likewise."""
        return self._ways.sub_loops

    def node(self, label: str) -> Node:
        """Where a node stands: its window of the drive, forces and travels.

        Under a force the number of its branch is that of the state among all, counted from 0 with
        the innermost cell as the first digit.

        Raises:
            ValueError: a state that the chain cannot have, in which it cannot stand, or with cells
                in transit and not come to yet.
        """
        return self._ways.node(label)

    def transition(self, label: str, direction: int) -> tuple[str, Transition] | None:
        """Where the drive's rise (+1) or fall (-1) leads from a node; None where it ends.

        Raises:
            ValueError: as for `node`.
            StaticsError: the engine could not go on; its text says what to do.
        """
        return self._ways.transition(label, direction)

    def up(self, label: str) -> tuple[str, Transition] | None:
        """Where the drive's rise leads from a node, and what happens; None where it ends."""
        return self.transition(label, +1)

    def down(self, label: str) -> tuple[str, Transition] | None:
        """Where the drive's fall leads from a node, and what happens; None where it ends."""
        return self.transition(label, -1)

    def stroke(self, label: str, direction: int) -> Iterator[tuple[str, Transition]]:
        """Where the drive's rise (+1) or fall (-1) leads from a node, until the drive ends.

        From `zero` up, and down again from where that ends, it goes round the main loop.

        Yields:
            One node after the other, by label, and what happened on the way there.

        Raises:
            ValueError, StaticsError: as for `transition`.
        """
        while (way := self.transition(label, direction)) is not None:
            label = way[0]
            yield way

    def walked(
        self,
        start: str | None = None,
        *,
        most: int = 24,
        progress: Callable[[int, int], None] | None = None,
    ) -> Walked:
        """The first nodes of `walk`, each with where it leads.

        Args:
            start: label to begin with; all cells at 0 by default.
            most: nodes after which it ends.
            progress: called with (done, most) nodes.

        Raises:
            ValueError: as for `walk`.
        """
        start = self.zero if start is None else start
        steps: list[Step] = []
        for node in self.walk(start, most=most):
            if progress is not None:
                progress(len(steps), most)
            steps.append(Step(node, self.up(node.label), self.down(node.label)))
        return Walked(self, start, tuple(steps), len(steps) < most)

    def walk(self, start: str | None = None, *, most: int = 1000) -> Iterator[Node]:
        """Nodes that the actuator can bring the chain to, those after fewest transitions first.

        Args:
            start: label to begin with; all cells at 0 by default.
            most: nodes after which it ends. If fewer come, they are all.

        Yields:
            Each node once, as soon as it is come to.

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
        self, start: str | None = None, *, progress: Callable[[int, int], None] | None = None
    ) -> transition_graph.TransitionGraph:
        """The same graph listed. All else as for `Chain.graph`."""
        return transition_graph.graph(self.chain, start=start, progress=progress)

    def __repr__(self):
        return f"ImplicitGraph({self.cells} cells driven by {self.actuator})"

    @property
    def summary(self) -> str:
        """How large the graph is, in a line."""
        vertices = shown_count(self.vertex_count)
        return f"{self.cells} cells driven by {self.actuator}: {vertices} vertices, not listed"

    @property
    def facts(self) -> dict[str, str]:
        """What is known of the graph without listing it, in words."""
        counts = {
            "transitions": self.transition_count,
            "from all at 0": self.reached_count,
            "sub-loops": self.sub_loop_count,
            "Garden of Eden": self.garden_count,
        }
        known = {name: shown_count(count) for name, count in counts.items() if count is not None}
        if self.by_fields:
            up = self._order(self.zero, +1)
            down = self._order(self.chain.last_state, -1)
            known = {"main loop, up": up, "main loop, down": down} | known
            known |= {"return-point memory": "holds", "avalanches": "none"}
        lost = ", ".join(name for name, count in counts.items() if count is None)
        if lost:
            known["not counted"] = f"{lost}: only following all of it tells"
        return known

    def __str__(self):
        return "\n".join([self.summary, *(f"{k:<20} {text}" for k, text in self.facts.items())])

    def _order(self, label: str, direction: int) -> str:
        """The cells that move first on a stroke from there, by name."""
        first = islice(self.stroke(label, direction), _SHOWN + 1)
        names = [self.names[i] for _, snap in first for i in snap.cells]
        return ", ".join([*names[:_SHOWN], *["..."] * (len(names) > _SHOWN)])


_SHOWN = 6  # cells of an order
# A longer number is told by its first digits.
_DIGITS = 15


def shown_count(count: int) -> str:
    """A number of states for people, in full or by its first digits and its power of ten."""
    return str(count) if count < 10**_DIGITS else f"{Decimal(count):.3e}".replace("e+", "e")


def implicit_graph(chain: mechanism.Chain, drive: Drive = None) -> ImplicitGraph:
    """The transition graph of a chain, not listed. All else as for `Chain.implicit_graph`."""
    return ImplicitGraph(driven(chain, drive))
