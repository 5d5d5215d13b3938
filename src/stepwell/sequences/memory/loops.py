"""Hysteresis loops in a transition graph: the main one, and those nested in it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import takewhile

import numpy as np

from stepwell.base import ByValue, Ints, number
from stepwell.sequences.graphs import Atlas


@dataclass(frozen=True, slots=True, eq=False)
class Loop(ByValue):
    """A pair of branches (μ, ν) such that the drive's rise leads from μ to ν and its fall back.

    Going to and fro between `low` and `high` the chain goes round it for ever.

    Attributes:
        low, high: the least range of the drive that goes round it [m, or the graph's unit]: the
            drives at which ν falls back to μ, and μ's rise arrives at ν.
        up: labels of the nodes that the rise passes, from where the chain lands on μ to where it
            lands on ν.
        down: the same for the fall, from ν to μ.

    Source: Mungan and Terzi 2019, "The structure of state transition graphs in systems with
    return point memory: I. General theory", with branches for states.
    """

    low: float
    high: float
    up: tuple[str, ...]
    down: tuple[str, ...]

    @property
    def vertices(self) -> tuple[str, ...]:
        """Labels of those with every cell in a phase, each once, in the order of the visit."""
        return tuple(dict.fromkeys(label for label in self.up + self.down if "-" not in label))

    def __str__(self):
        passed = [*self.up, *self.down[1:]]
        ends = (0, len(self.up) - 1, len(passed) - 1)
        return ">".join(v for k, v in enumerate(passed) if "-" not in v or k in ends)

    def __repr__(self):
        return f"Loop({self}, drive {number(self.low)} to {number(self.high)})"


def main_loop(atlas: Atlas) -> Loop:
    """From all cells at 0 up to where the drive ends, and back."""
    nodes = atlas.graph.nodes
    zero = nodes.find(atlas.graph.zero)
    assert zero is not None
    up = atlas.following(zero, +1)
    down = atlas.following(up[-1], -1)
    return _loop(atlas, up[0], up[-1], up, down)


def loop_pairs(atlas: Atlas, among: Ints) -> Ints:
    """(M, 2) all pairs (μ, ν) of these branches that make a loop, the main one left out."""
    branches = atlas.mesostates
    found = [np.empty((0, 2), int)]
    low = np.array(among)
    high = branches.rise[low]
    while np.any(high >= 0):
        low, high = low[high >= 0], high[high >= 0]
        closed = branches.falls_to(high, low)
        found.append(np.column_stack([low[closed], high[closed]]))
        high = branches.rise[high]
    pairs = np.concatenate(found)
    main = (pairs[:, 0] == atlas.bottom) & (branches.rise[pairs[:, 1]] < 0)
    pairs = pairs[~main]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def loop_of(atlas: Atlas, low: int, high: int) -> Loop:
    """The loop of a pair of branches."""
    onto_high = _landing(atlas, low, high, +1)
    onto_low = _landing(atlas, high, low, -1)
    up = [*takewhile(lambda node: node != onto_high, atlas.following(onto_low, +1)), onto_high]
    down = [*takewhile(lambda node: node != onto_low, atlas.following(onto_high, -1)), onto_low]
    branch_of = atlas.branch_of
    last_up = next(node for node in reversed(up) if branch_of[node] != high)
    last_down = next(node for node in reversed(down) if branch_of[node] != low)
    return _loop(atlas, last_down, last_up, up, down)


def _loop(atlas: Atlas, low: int, high: int, up: list[int], down: list[int]) -> Loop:
    """The loop between the drives at which two nodes end, through nodes on the way up and down."""
    nodes = atlas.graph.nodes
    ends = float(nodes.low[low]), float(nodes.high[high])
    return Loop(*ends, tuple(map(nodes.label, up)), tuple(map(nodes.label, down)))


def _landing(atlas: Atlas, start: int, goal: int, direction: int) -> int:
    """The node of a branch on which the chain lands, coming from another one."""
    first = int(atlas.nodes_of(start)[-1 if direction > 0 else 0])
    return next(v for v in atlas.following(first, direction) if atlas.branch_of[v] == goal)
