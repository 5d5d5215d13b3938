"""Hysteresis loops, latches, return-point memory and scrambling of a transition graph."""

from dataclasses import dataclass
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, ByValue, Ints, grouped, number
from stepwell.sequences.mesostates import BranchAtlas, Mesostates, Routes
from stepwell.sequences.nodes import Transition
from stepwell.sequences.transition_graph import TransitionGraph


@dataclass(frozen=True, slots=True, eq=False)
class Loop(ByValue):
    """A pair of branches (μ, ν) such that the drive's rise leads from μ to ν and its fall back.

    A drive that cycles between `low` and `high` repeats it.

    Attributes:
        low, high: the least range of the drive that repeats it [m, or the graph's unit]: the
            drives at which ν falls back to μ, and μ's rise arrives at ν.
        up: labels of the nodes passed by the rise from its landing on μ to its landing on ν.
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
        """Labels of the nodes with every cell in a phase, each once, in the order of the visit."""
        return tuple(dict.fromkeys(label for label in self.up + self.down if "-" not in label))

    def __str__(self):
        passed = [*self.up, *self.down[1:]]
        ends = (0, len(self.up) - 1, len(passed) - 1)
        return ">".join(v for k, v in enumerate(passed) if "-" not in v or k in ends)

    def __repr__(self):
        return f"Loop({self}, drive {number(self.low)} to {number(self.high)})"


def main_loop(atlas: BranchAtlas) -> Loop:
    """The loop from all cells at 0 up to the end of the drive, and back."""
    zero = atlas.graph.nodes.find(atlas.graph.zero)
    assert zero is not None
    up = atlas.following(zero, +1)
    down = atlas.following(up[-1], -1)
    return _loop(atlas, up[0], up[-1], up, down)


def loop_pairs(atlas: BranchAtlas, among: Ints) -> Ints:
    """(M, 2) all pairs (μ, ν) of these branches that make a loop, without the main loop."""
    branches = atlas.mesostates
    blocks = [np.empty((0, 2), int)]
    low = np.array(among)
    high = branches.rise[low]
    while np.any(high >= 0):
        low, high = low[high >= 0], high[high >= 0]
        closed = branches.falls_to(high, low)
        blocks.append(np.column_stack([low[closed], high[closed]]))
        high = branches.rise[high]
    pairs = np.concatenate(blocks)
    main = (pairs[:, 0] == atlas.bottom) & (branches.rise[pairs[:, 1]] < 0)
    pairs = pairs[~main]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def loop_of(atlas: BranchAtlas, low: int, high: int) -> Loop:
    """The loop of a pair of branches."""
    onto_high = _landing(atlas, low, high, +1)
    onto_low = _landing(atlas, high, low, -1)
    up = [*takewhile(lambda node: node != onto_high, atlas.following(onto_low, +1)), onto_high]
    down = [*takewhile(lambda node: node != onto_low, atlas.following(onto_high, -1)), onto_low]
    # The chain leaves for ν and for μ from the node before the landing.
    return _loop(atlas, down[-2], up[-2], up, down)


def _loop(atlas: BranchAtlas, low: int, high: int, up: list[int], down: list[int]) -> Loop:
    """The loop between the drives at which two nodes end, through nodes on the way up and down."""
    nodes = atlas.graph.nodes
    ends = float(nodes.low[low]), float(nodes.high[high])
    return Loop(*ends, tuple(map(nodes.label, up)), tuple(map(nodes.label, down)))


def _landing(atlas: BranchAtlas, start: int, goal: int, direction: int) -> int:
    """The node of a branch on which the chain lands, coming from another one."""
    first = int(atlas.nodes_of(start)[-1 if direction > 0 else 0])
    return next(v for v in atlas.following(first, direction) if atlas.branch_of[v] == goal)


@dataclass(frozen=True, slots=True, eq=False)
class Latch(ByValue):
    """Strongly connected nodes and the irreversible transitions out of them.

    Every state reached from all cells at 0 returns to it if the drive goes down, so these states
    have no latch; a latch leaves states that were set by hand. (An actuator that never goes all the
    way down may have more latches. These follow from the drives of the transitions.)

    Attributes:
        nodes: labels of the nodes that are left.
        ways: (from, to, transition) for each transition out of them.

    Source: transitions between strongly connected components, Mungan et al. 2019, Phys. Rev. Lett.
    123, 178002.
    """

    nodes: tuple[str, ...]
    ways: tuple[tuple[str, str, Transition], ...]

    def __repr__(self):
        ways = ", ".join(f"{a}>{b}" for a, b, _ in self.ways)
        return f"Latch({ways} for good)"


def latches(graph: TransitionGraph, groups: Ints) -> tuple[Latch, ...]:
    """All latches, one for each set of nodes that is left; `groups` as of `groups_of`."""
    leaves = (graph.target >= 0) & (groups[graph.target] != groups)
    ways: dict[int, list[tuple[str, str, Transition]]] = {}
    # For each node first the rise, then the fall.
    for node, row in np.argwhere(leaves.T[:, ::-1]).tolist():
        at = 1 - row, node
        a, b = graph.nodes.label(node), graph.nodes.label(int(graph.target[at]))
        ways.setdefault(int(groups[node]), []).append((a, b, graph.ways[graph.number[at]]))
    unsorted = [
        Latch(tuple(sorted(graph.nodes.labels(np.flatnonzero(groups == group)))), tuple(out))
        for group, out in ways.items()
    ]
    return tuple(sorted(unsorted, key=lambda latch: latch.nodes))


def groups_of(graph: TransitionGraph) -> Ints:
    """(R,) number of each node's strongly connected component: nodes that lead to each other."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    row, begin = np.nonzero(graph.target >= 0)
    ends, size = (begin, graph.target[row, begin]), len(graph)
    leads = csr_array((np.ones(len(begin), np.int8), ends), (size, size))
    return connected_components(leads, connection="strong")[1].astype(int)


def gardens(graph: TransitionGraph, groups: Ints) -> tuple[str, ...]:
    """Vertices without a predecessor: alone in a component that no transition enters.

    Behind a spring the chain may return to such a vertex from nodes that only it leads to.
    """
    into = (graph.target >= 0) & (groups[graph.target] != groups)
    vertices = graph.nodes.vertices
    alone = np.bincount(groups[vertices], minlength=len(graph)) == 1
    alone[groups[graph.target[into]]] = False
    return tuple(graph.nodes.labels(vertices[alone[groups[vertices]]]))


# Number of failures that are compared for the simplest one.
_COMPARED = 200


@dataclass(frozen=True, slots=True, eq=False)
class Forgetting(ByValue):
    """A turning point that the chain does not remember.

    The chain was at `first` when the drive arrived at `at`. The drive turned, went to `excursion`
    and came back, and never passed the earlier turning point `before`. Then the chain was at
    `later`.

    Attributes:
        turns: turning points [m, or the graph's unit] from the drive's lower end, with all cells
            at 0; the last four are before, at, excursion, at.
        first, later: labels of the nodes.
    """

    turns: tuple[float, ...]
    first: str
    later: str

    @property
    def before(self) -> float:
        """The earlier turning point: a minimum below `at`, or a maximum above it."""
        return self.turns[-4]

    @property
    def at(self) -> float:
        """The turning point that is forgotten."""
        return self.turns[-1]

    @property
    def excursion(self) -> float:
        """The turning point between the two visits of `at`."""
        return self.turns[-2]

    def __repr__(self):
        points = ", ".join(number(drive) for drive in self.turns)
        return f"Forgetting({self.first}, later {self.later}, drive {points})"


@dataclass(frozen=True, slots=True, eq=False)
class ReturnPointMemory(ByValue):
    """Return-point memory of the states that are reachable with one actuator.

    It holds if for any drives u0 ≤ u' ≤ u and any state at u0: a drive that rises from u0 to u,
    falls to u' and rises to u again leads to the same state as at the first arrival at u; and the
    same for falling drives. Then nested excursions have no effect either: the innermost can be
    omitted first.

    Attributes:
        witness: an example of its failure; None where it holds.

    Source: Barker et al. 1983; Sethna et al. 1993, Phys. Rev. Lett. 70, 3347; Mungan and Terzi
    2019 for graphs.
    """

    witness: Forgetting | None

    @property
    def holds(self) -> bool:
        """Whether every turning point is remembered."""
        return self.witness is None

    def __repr__(self):
        return "ReturnPointMemory(holds)" if self.holds else f"ReturnPointMemory({self.witness!r})"


class _Lapse(NamedTuple):
    """Branches of a failure, for a drive that may be mirrored.

    The chain rises out of `left` into `first`, falls out of it as far as `turned`, which it
    entered at the drive `entered`, and rises from there to `later`.
    """

    left: int
    first: int
    turned: int
    entered: float
    later: int


def return_point_memory(atlas: BranchAtlas, routes: Routes) -> ReturnPointMemory:
    """Exact check of all possible turns, by branches."""
    for direction in (+1, -1):
        branches = atlas.mesostates.toward(direction)
        lapses = [
            x
            for x in _lapses(branches, routes)
            if not _meet_in_vertex(atlas, branches, x, direction)
        ]
        if lapses:
            return ReturnPointMemory(_simplest(atlas, routes, branches, lapses, direction))
    return ReturnPointMemory(None)


def _lapses(branches: Mesostates, routes: Routes) -> list[_Lapse]:
    """Failures at a maximum.

    The chain enters `first` at e, where the branch before it ends, and stays on it for u from e on.
    If it returns to `first` at a u just above e, it does so at any larger u. The excursion may go
    down to the least end of all branches from which the rise leads there.
    """
    left = np.flatnonzero(routes.reached & (branches.rise >= 0))
    first = branches.rise[left]
    room = branches.high[first] - branches.high[left]
    # A branch entered at its very end is left again at once.
    left, first, room = left[room > 0], first[room > 0], room[room > 0]
    just_above = branches.high[left] + np.minimum(branches.slip, room / 2)
    least = _least_end(branches, routes)[left] + branches.slip
    lapses: list[_Lapse] = []
    rows, at = np.arange(len(left)), first
    while True:
        go = (branches.low[at] > least[rows]) & (branches.fall[at] >= 0)
        if not np.any(go):
            return lapses
        rows, entered = rows[go], branches.low[at[go]]
        at = branches.fall[at[go]]
        later = branches.risen(at, just_above[rows])
        for k in np.flatnonzero(later != first[rows]).tolist():
            turned, drive, end = int(at[k]), float(entered[k]), int(later[k])
            lapses.append(_Lapse(int(left[rows[k]]), int(first[rows[k]]), turned, drive, end))


def _meet_in_vertex(
    atlas: BranchAtlas, branches: Mesostates, lapse: _Lapse, direction: int
) -> bool:
    """Whether two branches meet in one vertex there, after which a tie separates them."""
    at, ends = direction * _turning(branches, lapse), (lapse.first, lapse.later)
    first, later = (atlas.graph.node(atlas.label_at(number, at)).state for number in ends)
    return first == later and "-" not in first


def _turning(branches: Mesostates, lapse: _Lapse) -> float:
    """The middle of the drives at which both branches exist."""
    high = branches.high
    return (float(high[lapse.left]) + float(min(high[lapse.first], high[lapse.later]))) / 2


def _least_end(branches: Mesostates, routes: Routes) -> np.ndarray:
    """(R,) the lowest lower end of the reached branches from which the rise leads to each."""
    least = np.where(routes.reached, branches.low, np.inf)
    rises = np.flatnonzero(routes.reached & (branches.rise >= 0))
    for _ in range(len(branches)):
        before = least.copy()
        np.minimum.at(least, branches.rise[rises], least[rises])
        if np.array_equal(least, before):
            break
    return least


def _simplest(
    atlas: BranchAtlas, routes: Routes, branches: Mesostates, lapses: list[_Lapse], direction: int
) -> Forgetting:
    """The failure whose first turning point is reached with the fewest snaps."""
    reached = np.flatnonzero(routes.reached).tolist()
    sources = grouped((int(branches.rise[branch]), branch) for branch in reached)
    begins: list[tuple[int, int, _Lapse]] = []
    for lapse in lapses[:_COMPARED]:
        waiting = [lapse.left]
        while waiting:
            number = waiting.pop()
            waiting += sources.get(number, [])
            if branches.low[number] < lapse.entered - branches.slip:
                begins.append((int(routes.depth[number]), number, lapse))
    _, start, lapse = min(begins)
    low, high = branches.low, branches.high
    before = float(low[start])
    if branches.fall[start] >= 0:
        # Well inside, so that no turning point is at an end.
        before += (min(lapse.entered, float(high[start])) - before) / 4
    excursion = (max(float(low[lapse.turned]), before) + lapse.entered) / 2
    at = _turning(branches, lapse)
    before, excursion, at = (direction * drive for drive in (before, excursion, at))
    turns = *routes.turns(start, before), at, excursion, at
    return Forgetting(turns, *(atlas.label_at(one, at) for one in (lapse.first, lapse.later)))


_BLOCK = 1 << 16  # vertices in one block


@dataclass(frozen=True, slots=True, eq=False)
class Scrambling(ByValue):
    """Two cells whose order depends on the state of the others.

    Attributes:
        cells: (i, j), indices in chain.cells; the text counts cells from 1.
        direction: +1 where both have a phase to rise to and the drive rises, -1 where both have one
            to fall to and it falls; with two phases each, both are at 0 or both at 1.
        i_first, j_first: vertices from which i flips before j, and j before i.
        reachable: whether both can be reached from all cells at 0, without setting one by hand.

    Source: Bense and van Hecke 2021, PNAS 118, e2111436118; van Hecke 2021, Phys. Rev. E 104,
    054608.
    """

    cells: tuple[int, int]
    direction: int
    i_first: str
    j_first: str
    reachable: bool

    def __repr__(self):
        way = "up" if self.direction > 0 else "down"
        i, j = (cell + 1 for cell in self.cells)
        return f"Scrambling({way}: cell {i} before {j} from {self.i_first}, not {self.j_first})"


def scrambling(graph: TransitionGraph, reached: Ints, others: Ints) -> tuple[Scrambling, ...]:
    """Every scrambled pair of flips once, with reachable states if there are any.

    A vertex gives the order of the flips on the way to the next one, relative to all possible
    flips that did not happen. `reached` are the vertices that are reachable from all cells at 0,
    `others` the remaining ones.
    """
    vertices = np.concatenate([reached, others])
    last = np.max(graph.nodes.phases(vertices), axis=0).astype(int)
    # Flip m is that of cell[m] out of phase step[m], and of a falling drive back to it.
    cell = np.repeat(np.arange(len(last)), last)
    step = np.arange(len(cell)) - np.searchsorted(cell, cell)
    scramblings: list[Scrambling] = []
    for direction in (+1, -1):
        order = _Order(graph, cell, step, direction)
        # before[i, j]: whether flip i is before flip j somewhere.
        known = before = np.zeros((len(cell),) * 2, bool)
        for part, more, reachable in ((reached, reached, True), (vertices, others, False)):
            before = before | order.before(more)
            scrambled = before & before.T & ~known
            known = known | scrambled
            for i, j in np.argwhere(np.triu(scrambled)).tolist():
                i_first, j_first = (order.example(part, *pair) for pair in ((i, j), (j, i)))
                cells, label = (int(cell[i]), int(cell[j])), graph.nodes.label
                orders = label(i_first), label(j_first)
                scramblings.append(Scrambling(cells, direction, *orders, reachable))
    return tuple(scramblings)


@dataclass(frozen=True, eq=False)
class _Order:
    """Which of M flips, out of `step` of `cell`, are on the way from a vertex, and which wait."""

    graph: TransitionGraph
    cell: Ints
    step: Ints
    direction: int

    def before(self, vertices: Ints) -> Bools:
        """(M, M) whether flip i is on the way from one of these vertices while flip j waits."""
        pairs = np.zeros((len(self.cell),) * 2, bool)
        for begin in range(0, len(vertices), _BLOCK):
            flips, waits = self._flips_and_waits(vertices[begin : begin + _BLOCK])
            pairs |= flips.T.astype(np.float32) @ waits.astype(np.float32) > 0
        return pairs

    def example(self, vertices: Ints, i: int, j: int) -> int:
        """The first of these vertices from which flip i is on the way while flip j waits."""
        for begin in range(0, len(vertices), _BLOCK):
            part = vertices[begin : begin + _BLOCK]
            flips, waits = self._flips_and_waits(part)
            if np.any(does := flips[:, i] & waits[:, j]):
                return int(part[np.argmax(does)])
        raise AssertionError("before() returned True, so there is one")

    def _flips_and_waits(self, vertices: Ints) -> tuple[Bools, Bools]:
        """(V, M) for each flip, whether it is on the way, and whether it waits."""
        leads, nodes = self.graph.target[int(self.direction > 0)], self.graph.nodes
        is_vertex = np.zeros(len(nodes) + 1, bool)
        is_vertex[nodes.vertices] = is_vertex[-1] = True
        after = leads[vertices]
        for _ in range(len(nodes)):
            between = ~is_vertex[after]
            if not np.any(between):
                break
            after = np.where(between, leads[after], after)
        # With no vertex to come nothing flips.
        after = np.where(after < 0, vertices, after)
        here, there = (nodes.phases(one)[:, self.cell] for one in (vertices, after))
        ready = here == self.step + (self.direction < 0)
        flips = ready & ((there > self.step) == (self.direction > 0))
        return flips, ready & ~flips
