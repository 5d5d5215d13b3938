"""What a figure has to find in a transition graph: ways worth drawing, and those of a program."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import InputError
from stepwell.sequences import TransitionKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from stepwell.sequences import Program, TransitionGraph

# Of the range of drives: closer ones are the same.
_SLIP = 1e-9


@dataclass(frozen=True, slots=True)
class FoldedTransition:
    """Where the rise (+1) or the fall (-1) of the drive leads from one shown node to the next.

    Attributes:
        source, target: labels of shown nodes.
        direction: of the drive.
        snaps: whether the chain snaps on the way.
    """

    source: str
    target: str
    direction: int
    snaps: bool


@dataclass(frozen=True, slots=True)
class FoldedGraph:
    """Vertices, the half-way nodes from which there is a choice, and the ways between them.

    Attributes:
        shown: labels of these nodes.
        ways: how they follow each other.
        levels: of each shown node how many switches it is from all cells at 0, at least; a cell
            half-way counts half.
        last: the level of all cells in their last phases.
    """

    shown: tuple[str, ...]
    ways: tuple[FoldedTransition, ...]
    levels: Mapping[str, float]
    last: int


def folded(graph: TransitionGraph, keep: Iterable[str] = ()) -> FoldedGraph:
    """Fold every half-way node into the way that leads over it, if it offers no other.

    A snap that lands half-way between two vertices offers one: turning back there leads to a
    vertex that the chain did not come from.

    Args:
        graph: what to fold.
        keep: labels of nodes to show in any case.
    """
    keep = set(keep)
    landings = set(graph.nodes.labels(np.unique(graph.target[graph.snaps])))
    shown = [label for label in graph if "-" not in label or label in landings | keep]
    ways = _ways(graph, shown)
    shown = [v for v in shown if "-" not in v or v in keep or _offers_a_choice(v, ways)]
    levels = {label: _level(graph, label) for label in shown}
    last = graph.cells if graph.chain is None else sum(map(int, graph.chain.last_state))
    last = max([last, *(math.ceil(level) for level in levels.values())])
    return FoldedGraph(tuple(shown), tuple(_ways(graph, shown)), levels, last)


def _level(graph: TransitionGraph, label: str) -> float:
    """The digits of a state added up, a cell half-way between two phases counting as such."""
    node, state = graph.node(label), label.partition("#")[0]
    total = 0.0
    for i, digit in enumerate(state):
        if digit != "-":
            total += int(digit)
        elif graph.chain is None:
            total += 0.5
        else:
            travel = (node.travel_low[i] + node.travel_high[i]) / 2
            total += sum(phase.high < travel for phase in graph.chain.phases[i]) - 0.5
    return total


def _offers_a_choice(label: str, ways: Sequence[FoldedTransition]) -> bool:
    """Whether turning back there leads elsewhere than to where the chain came from."""
    out = {way.direction: way.target for way in ways if way.source == label}
    return any(out.get(-way.direction) != way.source for way in ways if way.target == label)


def _ways(graph: TransitionGraph, shown: Sequence[str]) -> list[FoldedTransition]:
    known = set(shown)
    found: list[FoldedTransition] = []
    for source in shown:
        for direction in (1, -1):
            label, snaps = source, False
            while step := graph.transition(label, direction):
                label, transition = step
                snaps = snaps or transition.kind is TransitionKind.SNAP
                if label in known:
                    found.append(FoldedTransition(source, label, direction, snaps))
                    break
    return found


def followed(graph: TransitionGraph, program: Program) -> list[list[str]]:
    """Labels of the nodes visited on each stroke of a program, both ends included.

    A stroke that turns after a vertex has been passed smoothly might as well turn at the vertex,
    and ends there.

    Raises:
        ValueError: a program of another chain, or one that begins in a state not in the graph.
    """
    another = graph.chain is not None and graph.chain != program.chain
    if another or program.start not in graph:
        raise InputError(
            f"program: leads from {program.start} to {program.to} in another chain, or begins in a "
            f"state that this graph does not have. Draw the graph of its own chain: "
            f"program.chain.graph()."
        )
    points = program.turning_points
    slip = _SLIP * (max(points) - min(points))
    strokes: list[list[str]] = []
    label = program.start
    for before, after in pairwise(points):
        direction = 1 if after > before else -1
        stroke, snapped = [label], [True]
        while step := graph.transition(label, direction):
            left = direction * (after - step[1].drive)
            enters = abs(left) <= slip and "-" in label and "-" not in step[0]
            if left <= slip and not enters:
                break
            label = step[0]
            stroke.append(label)
            snapped.append(step[1].kind is TransitionKind.SNAP)
        while "-" in stroke[-1] and not snapped[-1]:
            stroke.pop()
            snapped.pop()
        strokes.append(stroke)
        label = stroke[-1]
    return strokes
