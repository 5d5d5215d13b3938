"""The best choice among drilled holes, or the proof that there is none."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.design.orders import Orders
from stepwell.kernels import entry, in_blocks, leaf, overspent, record, watched

# The bounds are tables of m² entries for every two cells, each at a cost of m³.
_MOST_ENTRIES = 20_000_000
_MOST_CANDIDATES = 1000
# Longer searches are compiled first.
_FEW_NODES = 2000
# Entries of paths per block of one core, each evaluated m times.
_BLOCK = 10_000_000


def fits(cells: int, candidates: int) -> bool:
    """Whether the candidates are few enough for a complete search."""
    small = cells**2 * candidates**2 <= _MOST_ENTRIES
    return small and candidates <= _MOST_CANDIDATES


# Of a type of band whose number is not limited.
UNLIMITED = 2**31


class Packs(NamedTuple):
    """Bands that are available, and bands of each of some candidates or kinds of cells.

    Attributes:
        band: (k,) number of its type of band.
        uses: (k,) number of bands that it needs.
        room: number of bands of each type.
    """

    band: Ints
    uses: Ints
    room: Ints

    def of(self, kind: Ints) -> Packs:
        """The same for candidates of these kinds."""
        return self._replace(band=self.band[kind], uses=self.uses[kind])


class Offered(NamedTuple):
    """Candidates that each cell may take.

    Attributes:
        allowed: (N, m) mask.
        packs: the bands of each candidate.
    """

    allowed: Bools
    packs: Packs

    @classmethod
    def freely(cls, allowed: Bools) -> Offered:
        """Candidates without a limit of their bands."""
        none = np.zeros(allowed.shape[1], np.int64)
        return cls(allowed, Packs(none, none, np.array([UNLIMITED])))


class Selection(NamedTuple):
    """Result of a search among candidates."""

    picks: Ints  # (N,) number of the candidate of every cell; empty if none meets both orders
    value: float  # sum, or smallest gap, -inf if there is none
    complete: bool  # whether the choice is proved the best, or none at all
    nodes: int  # number of partial choices


def best_choice(
    gap: Floats,
    offered: Offered,
    orders: Orders,
    *,
    add: bool,
    floor: float = -np.inf,
    most_nodes: int = 1_000_000,
) -> Selection:
    """One candidate per cell, above a floor, with the largest sum or smallest gap.

    Each order by itself is a longest path through the candidates, which needs no search. Cells are
    placed one by one in the order of F0. The remaining cells are bounded by the best paths of each
    order through the placed cells, without the other order. A branch is cut if that bound is no
    better than the best known value, or is -inf.

    Choices that need more bands than the packs hold are left out; the bounds ignore packs.

    `gap` (2, m, m) is the value of candidate a next below b, for F0 and F1, -inf if it is excluded.
    """
    allowed, packs = offered
    n, m = allowed.shape
    rising = np.array(orders.rising)
    segments = np.empty((n, n, m, m))
    second, takes = np.ascontiguousarray(gap[1]), allowed[rising[1]]

    def from_candidates(begin: int, end: int) -> None:
        part = np.empty((n, n, end - begin, m))
        _best_paths(second, takes, add, begin, part)
        segments[:, :, begin:end] = part

    size = max(1, _BLOCK // (n * n * m * m))
    in_blocks(from_candidates, m, _best_paths.block(size, second, takes, add, 0, segments))
    first, takes = np.ascontiguousarray(gap[0]), allowed[rising[0]]
    ahead = np.empty((n, m))
    _best_ends(first, takes, add, ahead)
    # Rank in F1 of the cells taken by rising F0.
    ranks = np.argsort(rising[1])[rising[0]]
    # Best paths from rank 0 to rank u at a, [0, u, a], and on to the last, [1, u, a].
    edges = np.stack([segments[0].max(axis=1), segments[:, -1].max(axis=2)])
    tables = _Tables(first, takes, ranks, segments, edges, ahead, add, *packs)
    few = min(most_nodes, _FEW_NODES)
    picks = np.full(n, -1)
    value, nodes, complete = _search(tables, floor, np.array([0, few]), picks)
    if not complete and few < most_nodes:
        picks[:] = -1
        search = _search.compiled()
        # Compile here, where Ctrl-C is handled.
        search(tables, floor, np.array([0, 0]), picks)
        value, nodes, complete = watched(
            lambda effort: search(tables, floor, effort, picks), most=most_nodes
        )
    of_cell = np.empty(n, np.int64)
    of_cell[rising[0]] = picks
    return Selection(of_cell if picks[0] >= 0 else np.empty(0, np.int64), value, complete, nodes)


@leaf
def _plus(a: float, b: float, add: bool) -> float:
    return a + b if add else min(a, b)


@entry(4e-7, "out")
def _best_paths(gap, allowed, add: bool, begin: int, out):
    """The best path from rank u at candidate a to rank v at b, out[u, v, a - begin, b]."""
    n, m = allowed.shape
    out[:] = -np.inf
    for u in range(n):
        for a in range(out.shape[2]):
            if allowed[u, begin + a]:
                out[u, u, a, begin + a] = 0.0 if add else np.inf
        for v in range(u + 1, n):
            for a in range(out.shape[2]):
                for c in range(m):
                    so_far = out[u, v - 1, a, c]
                    if so_far > -np.inf:
                        for b in range(m):
                            if allowed[v, b]:
                                value = _plus(so_far, gap[c, b], add)
                                if value > out[u, v, a, b]:
                                    out[u, v, a, b] = value


@entry(5e-7, "allowed")
def _best_ends(gap, allowed, add: bool, out):
    """The best path from place u at candidate a to the last place, out[u, a], (N, m)."""
    n, m = allowed.shape
    out[:] = -np.inf
    for a in range(m):
        if allowed[n - 1, a]:
            out[n - 1, a] = 0.0 if add else np.inf
    for u in range(n - 2, -1, -1):
        for a in range(m):
            if allowed[u, a]:
                for b in range(m):
                    out[u, a] = max(out[u, a], _plus(gap[a, b], out[u + 1, b], add))


@leaf
def _next_to(ranks, depth: int, rank: int, way: int) -> int:
    """The placed cell with the next rank above or below, -1 if there is none."""
    nearest = -1
    for k in range(depth):
        if way * (ranks[k] - rank) > 0 and (nearest < 0 or way * (ranks[k] - ranks[nearest]) < 0):
            nearest = k
    return nearest


@record
class _Tables(NamedTuple):
    """Values of choices of one of m candidates for each of N cells, in ascending F0."""

    gap: Floats  # (m, m) of F0
    allowed: Bools  # (N, m)
    ranks: Ints  # (N,) in F1
    segments: Floats  # (N, N, m, m) best paths of F1 between two ranks
    edges: Floats  # (2, N, m) best paths of F1 from the first rank, and to the last
    ahead: Floats  # (N, m) best paths of F0 to the last cell
    add: bool  # sums, else the smallest
    band: Ints  # (m,) number of the type of band
    uses: Ints  # (m,) number of bands
    room: Ints  # number of bands of each type


@leaf
def _bounds(tables: _Tables, depth: int, picks: Ints, value: float, out: Floats) -> None:
    """Upper bounds after placing each candidate next, out (m,)."""
    ranks, segments, edges, add = tables.ranks, tables.segments, tables.edges, tables.add
    rank = ranks[depth]
    # The placed cells next to it in F1, and the value of all other pieces between placed cells.
    below, above = _next_to(ranks, depth, rank, -1), _next_to(ranks, depth, rank, 1)
    rest = 0.0 if add else np.inf
    for k in range(depth):
        # The piece from k upwards, unless it is to be divided.
        at: int = ranks[k]
        own: int = picks[k]
        if k != below:
            after = _next_to(ranks, depth, at, 1)
            if after < 0:
                rest = _plus(rest, edges[1, at, own], add)
            else:
                rest = _plus(rest, segments[at, ranks[after], own, picks[after]], add)
        if k != above and _next_to(ranks, depth, at, -1) < 0:
            rest = _plus(rest, edges[0, at, own], add)
    for c in range(len(out)):
        out[c] = -np.inf
        if not tables.allowed[depth, c]:
            continue
        bound = _plus(rest, tables.ahead[depth, c], add)
        if depth > 0:
            last: int = picks[depth - 1]
            bound = _plus(bound, _plus(value, tables.gap[last, c], add), add)
        if below < 0:
            bound = _plus(bound, edges[0, rank, c], add)
        else:
            bound = _plus(bound, segments[ranks[below], rank, picks[below], c], add)
        if above < 0:
            bound = _plus(bound, edges[1, rank, c], add)
        else:
            bound = _plus(bound, segments[rank, ranks[above], c, picks[above]], add)
        out[c] = bound


@leaf
def _overdraws(tables: _Tables, picks: Ints, depth: int, c: int) -> bool:
    """Whether candidate c next needs more bands of its type than the placed cells leave."""
    band: int = tables.band[c]
    used: int = tables.uses[c]
    for k in range(depth):
        placed: int = picks[k]
        if tables.band[placed] == band:
            more: int = tables.uses[placed]
            used += more
    room: int = tables.room[band]
    return used > room


@entry()
def _search(tables: _Tables, floor: float, effort: Ints, best_of: Ints) -> tuple[float, int, bool]:
    """Search choices above `floor`: best value, number of nodes, and whether all were searched."""
    gap, add = tables.gap, tables.add
    n, m = tables.allowed.shape
    picks = np.full(n, -1)
    bound = np.empty((n, m))
    order = np.empty((n, m), np.int64)
    at = np.zeros(n, np.int64)
    value = np.empty(n + 1)  # of the pieces of F0 between placed cells
    value[0] = 0.0 if add else np.inf
    best, nodes, depth, c = floor, 0, 0, 0
    _bounds(tables, 0, picks, value[0], bound[0])
    order[0] = np.argsort(-bound[0], kind="mergesort")
    while depth >= 0:
        if at[depth] < m:
            c = order[depth, at[depth]]
            ceiling = bound[depth, c]
        else:
            ceiling = -np.inf
        # Differences within rounding do not count.
        if not ceiling > best + 1e-12 * abs(best) if best > -np.inf else ceiling == -np.inf:
            at[depth] = 0
            depth -= 1
            continue
        if overspent(effort, 1):
            return best, nodes, False
        nodes += 1
        at[depth] += 1
        if _overdraws(tables, picks, depth, c):
            continue
        picks[depth] = c
        if depth == n - 1:
            best = ceiling
            best_of[:] = picks
            continue
        before = value[depth]
        value[depth + 1] = _plus(before, gap[picks[depth - 1], c], add) if depth > 0 else before
        depth += 1
        at[depth] = 0
        _bounds(tables, depth, picks, value[depth], bound[depth])
        order[depth] = np.argsort(-bound[depth], kind="mergesort")
    return (best if best_of[0] >= 0 else -np.inf), nodes, True
