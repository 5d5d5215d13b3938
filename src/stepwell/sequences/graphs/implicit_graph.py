"""The transition graph of a chain with too many states to be listed: asked state by state."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from itertools import islice

from stepwell.base import ByValue, require
from stepwell.concave import relays
from stepwell.mechanism import Chain
from stepwell.sequences.branches import Drive, driven, refuse_friction
from stepwell.sequences.graphs.by_branches import ByBranches
from stepwell.sequences.graphs.by_fields import ByFields
from stepwell.sequences.graphs.node import Node, Transition
from stepwell.sequences.graphs.transition_graph import (
    TransitionGraph,
    about,
    graph,
    listable,
)
from stepwell.statics import Tie

Way = tuple[str, Transition] | None


@dataclass(frozen=True)
class Step:
    """A node of a walk, and where the drive's rise and fall lead from it.

    Attributes:
        node: where the walk is.
        up, down: the label of the next node and what happens; None where the way ends.
    """

    node: Node
    up: Way
    down: Way


@dataclass(frozen=True, eq=False)
class Walked:
    """A walk through a graph that is not listed, see `ImplicitGraph.walk`.

    Attributes:
        graph: of any chain.
        start: label of the node with which it begins.
        steps: the nodes, those after fewest transitions first.
        whole: whether these are all nodes that can be reached.
    """

    graph: ImplicitGraph
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

    chain: Chain

    def __post_init__(self):
        refuse_friction(self.chain)

    @cached_property
    def _ways(self) -> ByFields | ByBranches:
        # Under a force fields may tie: no cell feels which of two goes first.
        by_force = self.chain.actuator_stiffness == 0
        fields = relays(self.chain, ties=True) if by_force else None
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
        return str(about(self.chain)["actuator"])

    @property
    def unit(self) -> str:
        """Unit of drives: N under force control, m under others."""
        return self.chain.drive_unit

    @property
    def method(self) -> str:
        """How what it says is found, in words."""
        return self._ways.method

    @property
    def ties(self) -> tuple[Tie, ...]:
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
        return listable(self.chain)

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
    ) -> TransitionGraph:
        """The same graph listed. All else as for `Chain.graph`."""
        return graph(self.chain, start=start, progress=progress)

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


def implicit_graph(chain: Chain, drive: Drive = None) -> ImplicitGraph:
    """The transition graph of a chain, not listed. All else as for `Chain.implicit_graph`."""
    return ImplicitGraph(driven(chain, drive))
