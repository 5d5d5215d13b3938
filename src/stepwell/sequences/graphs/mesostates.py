"""A transition graph seen as its branches, in arrays: what each way of the drive does to them."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.sequences.branches import drive_slip
from stepwell.sequences.graphs.node import TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph, transitions


@dataclass(frozen=True, eq=False)
class Mesostates:
    """Every branch as one state: what the chain goes through to and fro without a snap.

    Attributes:
        low, high: (R,) drives between which each exists.
        rise, fall: (R,) where the snap at the upper and the lower end leads; -1: the drive ends.
        slip: drives closer than this are one.

    Source: Mungan, Sastry, Dahmen and Regev 2019, Phys. Rev. Lett. 123, 178002.
    """

    low: Floats
    high: Floats
    rise: Ints
    fall: Ints
    slip: float

    def __len__(self) -> int:
        return len(self.low)

    @property
    def mirrored(self) -> Mesostates:
        """The same with the drive counted downwards, so that what rises falls."""
        return Mesostates(-self.high, -self.low, self.fall, self.rise, self.slip)

    def toward(self, direction: int) -> Mesostates:
        """Itself for +1, mirrored for -1."""
        return self if direction > 0 else self.mirrored

    def risen(self, at: Ints, drive: Floats | float) -> Ints:
        """On which branches the chain stands when the drive has risen to `drive`."""
        at, drive = np.array(at), np.broadcast_to(drive, np.shape(at))
        for _ in range(len(self)):
            move = (self.high[at] < drive) & (self.rise[at] >= 0)
            if not np.any(move):
                break
            at[move] = self.rise[at[move]]
        return at

    def falls_to(self, at: Ints, goal: Ints) -> Bools:
        """Whether a falling drive leads from one branch to the other, at once or later."""
        at, found = np.array(at), np.zeros(len(at), bool)
        for _ in range(len(self)):
            at = np.where(at >= 0, self.fall[at], -1)
            found |= at == goal
            if np.all(found | (at < 0)):
                break
        return found

    def among(self, numbers: Ints) -> Mesostates:
        """These branches alone, renumbered; nothing may lead out of them."""
        place = np.full(len(self) + 1, -1)
        place[numbers] = np.arange(len(numbers))
        return Mesostates(
            self.low[numbers],
            self.high[numbers],
            place[self.rise[numbers]],
            place[self.fall[numbers]],
            self.slip,
        )


@dataclass(frozen=True, eq=False)
class Atlas:
    """A graph, its branches, and which nodes lie on which.

    Attributes:
        graph: what was drawn.
        up, down: the node that the drive's rise and fall leads to from a node.
        mesostates: the branches.
        labels: of the nodes on each branch, by rising drive.
        branch_of: the number of each node's branch.
    """

    graph: TransitionGraph
    up: dict[str, str]
    down: dict[str, str]
    mesostates: Mesostates
    labels: list[list[str]]
    branch_of: dict[str, int]

    @property
    def bottom(self) -> int:
        """The branch on which every cell is in its first phase."""
        return self.branch_of[self.graph.zero]

    def label_at(self, number: int, drive: float) -> str:
        """The node of a branch that exists at a drive."""
        node = self.graph.node
        return next(
            (label for label in self.labels[number] if drive <= node(label).high),
            self.labels[number][-1],
        )

    def following(self, label: str, direction: int) -> list[str]:
        """All nodes from this one on, itself included, until the drive ends."""
        steps = self.up if direction > 0 else self.down
        passed = [label]
        while (label := steps.get(label, "")) and len(passed) <= len(steps):
            passed.append(label)
        return passed


def atlas(graph: TransitionGraph) -> Atlas:
    """The branches of a graph."""
    up: dict[str, str] = {}
    down: dict[str, str] = {}
    above: dict[str, str] = {}
    snaps: list[tuple[str, str, int]] = []
    for a, b, transition in transitions(graph):
        (up if transition.direction > 0 else down)[a] = b
        if transition.kind is TransitionKind.SNAP:
            snaps.append((a, b, transition.direction))
        elif transition.direction > 0:
            above[a] = b
    labels: list[list[str]] = []
    for label in graph.nodes.keys() - above.values():
        labels.append([label])
        while label := above.get(label, ""):
            labels[-1].append(label)
    labels.sort(key=lambda on: graph.node(on[0]).branch)
    branch_of = {label: number for number, on in enumerate(labels) for label in on}
    low = np.array([graph.node(on[0]).low for on in labels])
    high = np.array([graph.node(on[-1]).high for on in labels])
    rise, fall = np.full(len(labels), -1), np.full(len(labels), -1)
    for a, b, direction in snaps:
        (rise if direction > 0 else fall)[branch_of[a]] = branch_of[b]
    strokes = [math.fsum(graph.node(label).travel_high) for label in graph]
    stroke = max(strokes) - min(strokes) if graph.unit == graph.measure.travel_unit else 0.0
    slip = drive_slip(float(np.max(high) - np.min(low)), stroke)
    return Atlas(graph, up, down, Mesostates(low, high, rise, fall, slip), labels, branch_of)


class Routes:
    """The way with fewest snaps from one branch to every other that can be reached.

    Args:
        mesostates: all branches.
        start: where the drive stands at its lower end.
    """

    def __init__(self, mesostates: Mesostates, start: int):
        self.mesostates = mesostates
        self.depth = np.full(len(mesostates), -1)
        self.depth[start] = 0
        self._came: dict[int, tuple[int, int]] = {}
        waiting = deque([start])
        steps = ((+1, mesostates.rise.tolist()), (-1, mesostates.fall.tolist()))
        while waiting:
            number = waiting.popleft()
            for direction, leads in steps:
                target = leads[number]
                if target >= 0 and self.depth[target] < 0:
                    self.depth[target] = self.depth[number] + 1
                    self._came[target] = number, direction
                    waiting.append(target)

    @property
    def reached(self) -> Bools:
        """(R,) whether each branch can be reached."""
        return self.depth >= 0

    def turns(self, number: int, drive: float) -> tuple[float, ...]:
        """Turning points from the drive's lower end to a drive within a branch, both included."""
        steps: list[tuple[int, int]] = []
        at = number
        while at in self._came:
            before, direction = self._came[at]
            steps.append((before, direction))
            at = before
        low, high = self.mesostates.low, self.mesostates.high
        points, way, entered = [float(low[at])], +1, float(low[at])
        for before, direction in reversed(steps):
            end = float(high[before] if direction > 0 else low[before])
            if direction != way:
                points.append(self._middle(before, way, entered))
            way, entered = direction, end
        if way * (drive - entered) < 0:
            points.append(self._middle(number, way, entered))
        if drive != points[-1]:
            points.append(drive)
        return tuple(points)

    def _middle(self, number: int, way: int, entered: float) -> float:
        """Where to turn on a branch that was entered there."""
        end = self.mesostates.high if way > 0 else self.mesostates.low
        return (entered + float(end[number])) / 2
