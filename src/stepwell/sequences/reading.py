"""Memory properties of a transition graph: loops, return-point memory, scrambling, counting."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Drawn, join_first
from stepwell.sequences import memory
from stepwell.sequences.counting import Counting, counting
from stepwell.sequences.exchange import drives_text
from stepwell.sequences.mesostates import Routes, atlas
from stepwell.sequences.transition_graph import TransitionGraph

# Larger numbers of loops are counted and not listed.
MOST_LOOPS = 2000
# In graphs with more branches, counting from states set by hand is not searched.
MOST_BY_HAND = 1000

_SHOWN = 6  # items of a list
_BY_HAND = " (set by hand)"


@dataclass(frozen=True, eq=False)
class MemoryReading(ByValue, Drawn):
    """Memory properties of a transition graph, in terms of the literature.

    A *branch* is a set of states connected without a snap; under force control that is one vertex.
    Mungan et al. (2019) call it a mesostate; their results for states and the drive's maps U and D
    hold for branches.

    Attributes:
        graph: the transition graph.
        branches: number of branches.
        main_loop: vertices on the way up between the extremes of the drive, and down.
        sub_loops: the other loops that can be reached from all cells at 0; None where there are
            more than `MOST_LOOPS` (Mungan and Terzi 2019).
        sub_loop_count: number of sub-loops.
        garden_of_eden: vertices without a predecessor, which can only be set by hand (Bense and
            van Hecke 2021); None where the graph began with one state.
        unreachable: vertices of the graph that cannot be reached from all cells at 0.
        return_point_memory: return-point memory of the states reachable from all cells at 0
            (Sethna et al. 1993).
        scrambling: pairs of cells that flip in either order (van Hecke 2021).
        counting: accumulators, whose response becomes periodic after two or more cycles of the
            drive (Kwakernaak and van Hecke 2023), from the states reachable from all cells at 0,
            and, in whole graphs of up to `MOST_BY_HAND` branches, from states set by hand.
            Return-point memory excludes the former: it makes the response periodic after one cycle.
        latches: irreversible transitions.

    Source: Mungan and Terzi 2019, Ann. Henri Poincaré 20, 2819; Terzi and Mungan 2020, Phys. Rev.
    E 102, 012122; van Hecke 2021, Phys. Rev. E 104, 054608.
    """

    graph: TransitionGraph
    branches: int
    main_loop: memory.Loop
    sub_loops: tuple[memory.Loop, ...] | None
    sub_loop_count: int
    garden_of_eden: tuple[str, ...] | None
    unreachable: tuple[str, ...]
    return_point_memory: memory.ReturnPointMemory
    scrambling: tuple[memory.Scrambling, ...]
    counting: Counting
    latches: tuple[memory.Latch, ...]

    def __repr__(self):
        turns = "return-point memory" if self.return_point_memory.holds else "forgets a turn"
        return (
            f"MemoryReading({self.graph.cells} cells, {self.branches} branches, "
            f"{self.sub_loop_count} sub-loops, {len(self.unreachable)} unreachable, {turns}, "
            f"{len(self.scrambling)} scrambled pairs, "
            f"{len(self.counting.accumulators)} accumulators, {len(self.latches)} latches)"
        )

    @property
    def summary(self) -> str:
        """Size of the graph, in one line."""
        graph = self.graph
        return (
            f"{graph.cells} cells driven by {graph.actuator}: {len(graph.nodes.vertices)} vertices "
            f"on {self.branches} branches"
        )

    @property
    def facts(self) -> dict[str, str]:
        """Text of each memory property, by name."""
        graph, names, counted = self.graph, self.graph.names, self.counting
        loops, gardens = self.sub_loops, self.garden_of_eden
        sub_loops = f"{self.sub_loop_count}"
        if loops is not None:
            sub_loops = f"{sub_loops}: {_listed(map(str, loops))}" if loops else _listed([])
        lapse, remembers = self.return_point_memory.witness, "holds"
        if lapse is not None:
            way = drives_text(graph.unit, lapse.turns, " → ")
            then, later = lapse.first, lapse.later
            remembers = f"fails: {way} leads to {then} at the first visit and to {later} later"
        scrambled = (
            f"{names[s.cells[0]]} {'up' if s.direction > 0 else 'down'} before {names[s.cells[1]]} "
            f"from {s.i_first}, after it from {s.j_first}{'' if s.reachable else _BY_HAND}"
            for s in self.scrambling
        )
        counts = (
            f"{'>'.join(a.states)} in cycles of {drives_text(graph.unit, (a.low, a.high))}"
            f"{_BY_HAND if a.by_hand else ''}"
            for a in counted.accumulators
        )
        part = "" if counted.exhaustive else " (searched in part)"
        eden = "not known: the graph began with one state" if gardens is None else _listed(gardens)
        ways = (f"{a}>{b}" for latch in self.latches for a, b, _ in latch.ways)
        facts = {
            "main loop": str(self.main_loop),
            "sub-loops": sub_loops,
            "Garden of Eden": eden,
            "not from all at 0": _listed(self.unreachable),
            "return-point memory": remembers,
            "scrambling": _listed(scrambled),
            "accumulators": f"{_listed(counts)}{part}",
            "latches": _listed(ways),
        }
        if graph.ties:
            facts["ties"] = f"{len(graph.ties)}, so other transitions are possible"
        return facts

    def __str__(self):
        lines = (f"{name:<21}{text}" for name, text in self.facts.items())
        return "\n".join([self.summary, *lines])


def read_memory(graph: TransitionGraph) -> MemoryReading:
    """Memory properties of a graph of any chain or of switching fields.

    All are exact, except that the search for accumulators is partial for too many extremes and
    branches (`reading.counting.exhaustive`).
    """
    branch_atlas = atlas(graph)
    routes = Routes(branch_atlas.mesostates, branch_atlas.bottom)
    pairs = memory.loop_pairs(branch_atlas, np.flatnonzero(routes.reached))
    listable = len(pairs) <= MOST_LOOPS
    vertices = graph.nodes.vertices
    reached = routes.reached[branch_atlas.branch_of[vertices]]
    turns = memory.return_point_memory(branch_atlas, routes)
    groups = memory.groups_of(graph)
    by_hand = graph.is_whole and len(branch_atlas.mesostates) <= MOST_BY_HAND
    # A graph with return-point memory can only count from states set by hand.
    counted = Counting((), True)
    if by_hand or not turns.holds:
        counted = counting(branch_atlas, routes, by_hand=by_hand)
    return MemoryReading(
        graph,
        len(branch_atlas.mesostates),
        memory.main_loop(branch_atlas),
        tuple(memory.loop_of(branch_atlas, *pair) for pair in pairs.tolist()) if listable else None,
        len(pairs),
        memory.gardens(graph, groups) if graph.is_whole else None,
        tuple(graph.nodes.labels(vertices[~reached])),
        turns,
        memory.scrambling(graph, vertices[reached], vertices[~reached]),
        counted,
        memory.latches(graph, groups),
    )


def _listed(items: Iterable[str]) -> str:
    return join_first([*items], _SHOWN) or "none"
