"""Claims about pairs of hysterons: how many graphs there are, and which of them chains make."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from itertools import pairwise, product

import numpy as np

from stepwell.mechanism import Chain
from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.others.curves import straight
from stepwell.paper.others.hysterons import Graph, canonical, graphs, reached, way_to
from stepwell.paper.others.inequalities import Inequalities, Points
from stepwell.sequences import TransitionGraph

WHERE = "Teunisse and van Hecke 2025"
OURS = f"ours, of the graphs of {WHERE}"
# Where the phases of a designed pair end [N]: at two valleys and two peaks.
ENDS = (-1.0, -0.8, 0.8, 1.0)
# Of its curves: straight pieces between two of them, how far they are designed beyond the outermost
# [N], and the room between lengths [mm].
_STEPS, _BEYOND, _ROOM = 4, (0.25, 0.5, 0.75), 0.5
# A spring behind which pairs are driven [N/m].
SPRING = 10e3


def possible(graph: Graph, *, plain: bool) -> bool:
    """Whether any pair makes a graph, under a prescribed length or behind a spring.

    Only the order of the four forces at which phases end counts, and the graph tells it. The
    travels are any that rise with the force, and so is what the spring gives.

    Args:
        graph: of two hysterons.
        plain: only with elements whose force is a function of travel, so that the second phase
            begins beyond the end of the first.
    """
    asked = Inequalities(graph, np.arange(4.0), (0, 1, 2, 3))
    asked.rise()
    asked.make(spring=True)
    if plain:
        for cell in (0, 1):
            asked.fall(cell, alone=False)
    return asked.hold()


@cache
def design(graph: Graph) -> tuple[Points, Points] | None:
    """Curves of two elements that make a graph under a prescribed length, by corners [mm, N].

    As few of them fold back as can be; None where no design was found.
    """
    inner = [np.linspace(a, b, _STEPS + 1)[:-1] for a, b in pairwise(ENDS)]
    below, above = ENDS[0] - np.array(_BEYOND[::-1]), ENDS[-1] + np.array((0.0, *_BEYOND))
    forces = np.concatenate([below, *inner, above])
    low, valley, peak, high = (len(_BEYOND) + k * _STEPS for k in range(4))
    for folded in sorted(product((False, True), repeat=2), key=sum):
        asked = Inequalities(graph, forces, (low, valley, peak, high))
        asked.rise()
        asked.make(spring=False)
        for cell in (0, 1):
            if folded[cell]:
                asked.fold(cell)
            else:
                asked.fall(cell, alone=True)
        found = asked.solution(_ROOM)
        if found is not None:
            return asked.points(0, found), asked.points(1, found)
    return None


@cache
def pairs() -> dict[Graph, Chain]:
    """The pair of every graph for which a design was found."""
    found = ((graph, design(graph)) for graph in graphs())
    return {graph: Chain([straight(one) for one in curves]) for graph, curves in found if curves}


def graph_of(chain: Chain, drive: str | float | None = None) -> Graph:
    """The graph of a pair of elements with two phases, as the engine follows it.

    Where a way leads tells the transition graph; which cell goes first tell the forces at which
    phases end, since both feel one force.
    """
    found = chain.graph(drive)
    fields = [cell.fields[0] for cell in chain.elements]
    ways: list[str] = []
    for state in ("00", "01", "10", "11"):
        for sign, phase, first in (("+", "0", min), ("-", "1", max)):
            cells = [cell for cell in (0, 1) if state[cell] == phase]
            if cells:
                leaving = first(cells, key=lambda cell: fields[cell][int(phase)])
                end = next_state(found, state, +1 if sign == "+" else -1)
                ways.append(way_to(state, sign, leaving, end))
    return tuple(sorted(ways))


def next_state(found: TransitionGraph, state: str, direction: int) -> str:
    """The next state with all cells in a phase, where the drive leads from one."""
    while (way := found.transition(state, direction)) is not None:
        state = way[0]
        if "-" not in state:
            return state.partition("#")[0]
    return "nowhere"


@claim(WHERE, "35", "exact")
def two_hysterons() -> Finding:
    """Two hysterons with fields that depend on the state have 35 transition graphs."""
    found = graphs()
    return judged(
        len(found) == 35,
        str(len(found)),
        note="All orders of the eight fields in which every state stands at some drive; graphs "
        "that differ by the numbers of the hysterons count once, and none has a loop or a race.",
    )


@claim(WHERE, "13", "exact")
def two_hysterons_reached() -> Finding:
    """Without their Gardens of Eden they are 13."""
    found = _seen(graphs())
    return judged(found == 13, str(found), note="States that no drive leads to from 00 left out.")


@claim(OURS, "not asked", "each design followed, the others excluded")
def pairs_under_force() -> Finding:
    """Under a prescribed force, two elements in series make 2 of the 35, 2 of the 13."""
    alone = {graph for graph in graphs() if all(len(way) == 4 for way in graph)}
    made = {canonical(graph_of(chain, "force")) for chain in pairs().values()}
    return judged(
        made == alone,
        _share(made),
        note="No element feels another, so a drive flips one at a time: of the 35 only these have "
        "no avalanche. The designs are those for a prescribed length.",
    )


@claim(OURS, "not asked", "each design followed, the others excluded")
def pairs_under_length() -> Finding:
    """Under a length, elements with one force for each travel make 8 of the 35, 5 of the 13."""
    return _whether_made(None)


@claim(OURS, "not asked", "each design followed, the others excluded")
def pairs_behind_a_spring() -> Finding:
    """Behind a spring such elements make the same 8."""
    return _whether_made(SPRING)


@claim(OURS, "not asked", "each design followed")
def pairs_that_fold() -> Finding:
    """With curves that fold back, pairs make all of the 13, under a length and behind a spring."""
    made = {
        graph
        for graph, chain in pairs().items()
        if _makes(chain, graph, None) and _makes(chain, graph, SPRING)
    }
    never = [graph for graph in graphs() if not possible(graph, plain=False)]
    undecided = len(graphs()) - len(made) - len(never)
    folded = [folding(pairs()[graph]) for graph in made]
    return judged(
        _seen(made) == 13,
        _share(made),
        note=f"{folded.count(0)} with no curve that folds back, {folded.count(1)} with one, "
        f"{folded.count(2)} with two. {len(never)} of the 35 are impossible: what they want of "
        f"elements that jump from phase to phase contradicts itself. {undecided} are undecided: in "
        f"each an element flips to and fro in one avalanche, and no design was found.",
    )


def _whether_made(drive: float | None) -> Finding:
    """Whether plain elements make just those graphs that are not excluded."""
    made = {graph for graph, chain in _plain().items() if _makes(chain, graph, drive)}
    others = {graph for graph in graphs() if possible(graph, plain=True)}
    return judged(
        made == others,
        _share(made),
        note="Where an element goes on, the shared force falls, so that no other one follows it: "
        "in any avalanche the elements go opposite ways. The other graphs have one in which they "
        "do not, and their inequalities contradict each other.",
    )


def _plain() -> dict[Graph, Chain]:
    """The pairs of which no curve folds back."""
    return {graph: chain for graph, chain in pairs().items() if not folding(chain)}


def folding(chain: Chain) -> int:
    """How many curves of a chain fold back."""
    return sum(len(cell.laws) > 1 for cell in chain.elements)


def _makes(chain: Chain, graph: Graph, drive: float | None) -> bool:
    return canonical(graph_of(chain, drive)) == graph


def _seen(found: Iterable[Graph]) -> int:
    """How many graphs are left without Gardens of Eden."""
    return len({canonical(reached(graph)) for graph in found})


def _share(made: set[Graph]) -> str:
    return f"{len(made)} of {len(graphs())}, {_seen(made)} of {_seen(graphs())}"


CLAIMS = (
    two_hysterons,
    two_hysterons_reached,
    pairs_under_force,
    pairs_under_length,
    pairs_behind_a_spring,
    pairs_that_fold,
)
