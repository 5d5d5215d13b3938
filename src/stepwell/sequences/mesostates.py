"""Mesostates: the branches of a transition graph in arrays, with their transitions."""

import math
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.sequences.branches import drive_slip
from stepwell.sequences.transition_graph import TransitionGraph


@dataclass(frozen=True, eq=False)
class Mesostates:
    """Branches as states: equilibria that are connected without a snap.

    Each exists between two drives; `rise` and `fall` are the targets of the snaps at its upper and
    its lower end, -1 where the drive ends. Drives closer than `slip` are one.

    Source: Mungan, Sastry, Dahmen and Regev 2019, Phys. Rev. Lett. 123, 178002.
    """

    low: Floats
    high: Floats
    rise: Ints
    fall: Ints
    slip: float

    def __len__(self) -> int:
        return len(self.low)

    def toward(self, direction: int) -> "Mesostates":
        """Itself for +1; for -1 with the sign of the drive reversed."""
        if direction > 0:
            return self
        return Mesostates(-self.high, -self.low, self.fall, self.rise, self.slip)

    def risen(self, at: Ints, drive: Floats | float) -> Ints:
        """Branches of the chain after the drive has risen to `drive`."""
        at = np.array(at)
        here, drive = at.ravel(), np.broadcast_to(drive, at.shape).ravel()
        going = np.arange(len(here))
        # Entries that are at their end are not evaluated again.
        for _ in range(len(self)):
            going = going[(self.high[here[going]] < drive[going]) & (self.rise[here[going]] >= 0)]
            if not len(going):
                break
            here[going] = self.rise[here[going]]
        return here.reshape(at.shape)

    def falls_to(self, at: Ints, goal: Ints) -> Bools:
        """Whether a falling drive leads from one branch to the other, at once or later."""
        here, reached = np.array(at), np.zeros(len(at), bool)
        going = np.arange(len(here))
        for _ in range(len(self)):
            here[going] = self.fall[here[going]]
            reached[going] = here[going] == goal[going]
            going = going[~reached[going] & (here[going] >= 0)]
            if not len(going):
                break
        return reached

    def among(self, numbers: Ints) -> "Mesostates":
        """These branches alone, renumbered; nothing may lead out of them."""
        place = np.full(len(self) + 1, -1)
        place[numbers] = np.arange(len(numbers))
        rise, fall = place[self.rise[numbers]], place[self.fall[numbers]]
        return Mesostates(self.low[numbers], self.high[numbers], rise, fall, self.slip)


@dataclass(frozen=True, eq=False)
class BranchAtlas:
    """A graph, its R nodes and B branches, by number.

    `on` are the nodes, branch after branch and on each by rising drive; those of branch b are
    on[first[b]] .. on[first[b + 1]].
    """

    graph: TransitionGraph
    mesostates: Mesostates
    on: Ints
    first: Ints
    branch_of: Ints

    @property
    def bottom(self) -> int:
        """The branch on which every cell is in its first phase."""
        zero = self.graph.nodes.find(self.graph.zero)
        assert zero is not None
        return int(self.branch_of[zero])

    def nodes_of(self, branch: int) -> Ints:
        """The nodes of a branch, by rising drive."""
        return self.on[self.first[branch] : self.first[branch + 1]]

    def label_at(self, branch: int, drive: float) -> str:
        """The node of a branch that exists at a drive."""
        own = self.nodes_of(branch)
        exists = np.flatnonzero(drive <= self.graph.nodes.high[own])
        return self.graph.nodes.label(int(own[exists[0] if len(exists) else -1]))

    def following(self, node: int, direction: int) -> list[int]:
        """All nodes from this one on, itself included, until the drive ends."""
        leads = self.graph.target[int(direction > 0)]
        passed = [node]
        while (node := int(leads[node])) >= 0 and len(passed) <= len(leads):
            passed.append(node)
        return passed


def atlas(graph: TransitionGraph) -> BranchAtlas:
    """The branches of a graph."""
    nodes, size = graph.nodes, len(graph)
    fall, rise = graph.target
    snap_down, snap_up = graph.snaps
    # Nodes of one branch lead to each other without a snap.
    above = np.where(snap_up, -1, rise)
    head = np.ones(size, bool)
    head[above[above >= 0]] = False
    heads = np.flatnonzero(head)
    heads = heads[np.argsort(nodes.branch[heads], kind="stable")]
    branch_of, place = np.full(size, -1), np.zeros(size, int)
    here, own, last, height = heads, np.arange(len(heads)), heads.copy(), 0
    while len(here):
        branch_of[here], place[here], last[own] = own, height, here
        goes = above[here] >= 0
        here, own, height = above[here][goes], own[goes], height + 1
    on = np.lexsort((place, branch_of))
    first = np.searchsorted(branch_of[on], np.arange(len(heads) + 1))
    low, high = nodes.low[heads], nodes.high[last]
    up, down = np.full(len(heads), -1), np.full(len(heads), -1)
    for leads, snaps, onto in ((rise, snap_up, up), (fall, snap_down, down)):
        onto[branch_of[snaps]] = branch_of[leads[snaps]]
    stroke = 0.0
    if graph.unit == graph.measure.travel_unit:
        strokes = [math.fsum(node.travel_high) for node in nodes]
        stroke = max(strokes) - min(strokes)
    slip = drive_slip(float(np.max(high) - np.min(low)), stroke)
    return BranchAtlas(graph, Mesostates(low, high, up, down, slip), on, first, branch_of)


class Routes:
    """Routes with the fewest snaps from the first branch to all reachable branches."""

    def __init__(self, mesostates: Mesostates, start: int):
        self.mesostates = mesostates
        self.depth = np.full(len(mesostates), -1)
        self.depth[start] = 0
        # Predecessor of each branch, and the direction of the drive.
        self._from = np.full(len(mesostates), -1)
        self._way = np.zeros(len(mesostates), np.int8)
        leads = np.column_stack([mesostates.rise, mesostates.fall])
        front, steps = np.array([start]), 0
        while len(front):
            steps += 1
            after = leads[front].ravel()
            new = np.flatnonzero((after >= 0) & (self.depth[after] < 0))
            # Each once, in the order of arrival.
            new = new[np.sort(np.unique(after[new], return_index=True)[1])]
            before, front = front[new // 2], after[new]
            self.depth[front], self._from[front] = steps, before
            self._way[front] = 1 - 2 * (new % 2)

    @property
    def reached(self) -> Bools:
        """(R,) whether each branch can be reached."""
        return self.depth >= 0

    def turns(self, number: int, drive: float) -> tuple[float, ...]:
        """Turning points from the drive's lower end to a drive within a branch, both included."""
        steps: list[tuple[int, int]] = []
        at = number
        while (before := int(self._from[at])) >= 0:
            steps.append((before, int(self._way[at])))
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
        end = self.mesostates.high if way > 0 else self.mesostates.low
        return (entered + float(end[number])) / 2
