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
    up = atlas.following(atlas.graph.zero, +1)
    down = atlas.following(up[-1], -1)
    node = atlas.graph.node
    return Loop(node(up[0]).low, node(up[-1]).high, tuple(up), tuple(down))


def loop_pairs(atlas: Atlas, among: Ints) -> list[tuple[int, int]]:
    """All pairs (μ, ν) of these branches that make a loop, the main one left out."""
    branches = atlas.mesostates
    found: list[tuple[int, int]] = []
    low = np.array(among)
    high = branches.rise[low]
    while np.any(high >= 0):
        low, high = low[high >= 0], high[high >= 0]
        closed = branches.falls_to(high, low)
        found += zip(low[closed].tolist(), high[closed].tolist(), strict=True)
        high = branches.rise[high]
    main = {(atlas.bottom, top) for top in np.flatnonzero(branches.rise < 0).tolist()}
    return sorted(pair for pair in found if pair not in main)


def loop_of(atlas: Atlas, pair: tuple[int, int]) -> Loop:
    """The loop of a pair of branches."""
    low, high = pair
    onto_high = _landing(atlas, low, high, +1)
    onto_low = _landing(atlas, high, low, -1)
    up = [*takewhile(lambda label: label != onto_high, atlas.following(onto_low, +1)), onto_high]
    down = [*takewhile(lambda label: label != onto_low, atlas.following(onto_high, -1)), onto_low]
    node, branch_of = atlas.graph.node, atlas.branch_of
    last_up = next(v for v in reversed(up) if branch_of[v] != high)
    last_down = next(v for v in reversed(down) if branch_of[v] != low)
    return Loop(node(last_down).low, node(last_up).high, tuple(up), tuple(down))


def _landing(atlas: Atlas, start: int, goal: int, direction: int) -> str:
    """The node of a branch on which the chain lands, coming from another one."""
    first = atlas.labels[start][-1 if direction > 0 else 0]
    return next(v for v in atlas.following(first, direction) if atlas.branch_of[v] == goal)
