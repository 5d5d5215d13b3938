"""The transition graph of concave cells of one travel, in closed form: by stroke and by force.

Under a stroke at most one cell is in transit, since two falling forces cannot balance. So the
chain stands at a *vertex*, every cell at a stop, or with one cell between its stops, and where that
ends one cell gives travel to another until one of the two arrives.

Source: ours (theory page, "Graphs in closed form").
"""

import numpy as np

from stepwell.base import Floats, InputError, Ints
from stepwell.concave.cell import force_at, full_travel, of_row, travel_at
from stepwell.concave.certificate import certify, end_forces, proved_ends
from stepwell.concave.sorting import TIED, rank, same_travel
from stepwell.kernels import entry, kernel

# Kind of actuator.
STROKE, FORCE = 0, 1
# Targets that are no node: the drive ends, or there is no such node.
END, NONE = -1, -2
# Status of a design: decided in closed form, or the reason why not.
DECIDED, NOT_PROVED, TIES, WAKES = 0, 1, 2, 3
# With more cells nearly every design has a different graph.
MOST_CELLS = 6

# Largest number of pieces of an exchange in the proof that no third cell starts to move.
_PIECES = 64
# Longest steps of a flow, as fractions of the full travel, that must give the same end; most steps.
_COARSE, _FINE, _STEPS = 0.01, 0.005, 10_000
# Time per number of a cell, interpreted [s].
_EACH = 3e-5
# Two remainders of 31 bits make a key.
_PRIMES, _FACTORS = (2147483647, 2147483629), (1000003, 999983)


@kernel
def _leader(ends: Floats, state: int, skip: int, side: int) -> int:
    """The cell but `skip` that switches first: at 0 with the least force, at 1 with the largest; or
    -1.
    """
    first = -1
    for cell in range(len(ends)):
        if cell != skip and state >> cell & 1 == side:
            own = ends[cell, side]
            if first < 0 or (own > ends[first, side] if side else own < ends[first, side]):
                first = cell
    return first


@kernel
def _limits(ends: Floats, state: int, a: int, b: int) -> tuple[float, float]:
    """Forces between which all cells but a and b stay at their stops."""
    low, high = -np.inf, np.inf
    for cell in range(len(ends)):
        if cell != a and cell != b:
            if state >> cell & 1:
                low = max(low, ends[cell, 1])
            else:
                high = min(high, ends[cell, 0])
    return low, high


@kernel
def _undisturbed(
    cells: Floats, ends: Floats, state: int, give: int, take: int, gives: float, takes: float
) -> bool:
    """Proof that no third cell starts to move while one cell gives travel to another.

    One force rises and one falls, so their end values bound the mean, the force of the chain.
    """
    giver, taker = of_row(cells[give]), of_row(cells[take])
    low, high = _limits(ends, state, give, take)
    pieces = 1
    while pieces <= _PIECES:
        piece, holds = (gives - takes) / pieces, True
        f, g = force_at(giver, gives)[0], force_at(taker, takes)[0]
        for k in range(1, pieces + 1):
            f_next = force_at(giver, gives - k * piece)[0]
            g_next = force_at(taker, takes + k * piece)[0]
            if k < pieces and not low < 0.5 * (f_next + g_next) < high:
                return False
            if not (0.5 * (f + g_next) > low and 0.5 * (f_next + g) < high):
                holds = False
            f, g = f_next, g_next
        if holds:
            return True
        pieces *= 2
    return False


@kernel
def _mean(force: Floats, travel: Floats, full: float) -> float:
    """The force at which travels of given sum flow: the mean of all cells that are free to move.

    A cell at 0 is free where its force is below that mean, a cell at 1 where it is above.
    """
    total, count = 0.0, 0
    for i in range(len(force)):
        if 0.0 < travel[i] < full:
            total, count = total + force[i], count + 1
    mean = total / count
    for _ in range(2 * len(force)):
        total, count = 0.0, 0
        for i in range(len(force)):
            waits = (travel[i] == 0.0 and force[i] >= mean) or (
                travel[i] == full and force[i] <= mean
            )
            if not waits:
                total, count = total + force[i], count + 1
        if total / count == mean:
            break
        mean = total / count
    return mean


@kernel
def _rates(cells: Floats, full: float, travel: Floats, force: Floats, rate: Floats) -> float:
    """Rates of the flow of travels of given sum, (N,) into `rate`; returns the largest."""
    for i in range(len(cells)):
        force[i] = force_at(of_row(cells[i]), travel[i])[0]
    mean, fastest = _mean(force, travel, full), 0.0
    for i in range(len(cells)):
        rate[i] = mean - force[i]
        if (travel[i] == 0.0 and rate[i] <= 0.0) or (travel[i] == full and rate[i] >= 0.0):
            rate[i] = 0.0
        fastest = max(fastest, abs(rate[i]))
    return fastest


@kernel
def _flow(cells: Floats, full: float, travel: Floats, step: float) -> int:
    """Integrate travels (N,) of given sum until one cell alone is in transit; returns it, or -1.

    By the midpoint rule in steps of at most `step` [m], and a simple one where a cell arrives.
    """
    # One function: a step uses three arrays that are made once.
    n = len(cells)
    force, rate, half = np.empty(n), np.empty(n), np.empty(n)
    for _ in range(_STEPS):
        moving, between = -1, 0
        for i in range(n):
            if 0.0 < travel[i] < full:
                moving, between = i, between + 1
        if between == 0:
            return -1
        fastest = _rates(cells, full, travel, force, rate)
        if between == 1 and fastest <= 1e-12 * abs(force[moving]):
            return moving
        arrives = False
        for i in range(n):
            half[i] = travel[i] + 0.5 * step / fastest * rate[i]
            arrives = arrives or (rate[i] != 0.0 and not 0.0 < half[i] < full)
        if not arrives:
            fastest = _rates(cells, full, half, force, rate)
        # Up to the end of the step, or until the first cell arrives.
        time, first = step / fastest, -1
        for i in range(n):
            room = full - travel[i] if rate[i] > 0.0 else travel[i]
            if rate[i] != 0.0 and room <= time * abs(rate[i]):
                time, first = room / abs(rate[i]), i
        for i in range(n):
            travel[i] = min(max(travel[i] + time * rate[i], 0.0), full)
        if first >= 0:
            travel[first] = full if rate[first] > 0.0 else 0.0
    return -1


@kernel
def _flowed(
    cells: Floats, full: float, state: int, moving: int, travel: float, other: int, step: float
) -> int:
    """Target node of a flow as for `_landing`, in steps [m]; -1 without an end."""
    n = len(cells)
    place = np.empty(n)
    for i in range(n):
        place[i] = full if state >> i & 1 else 0.0
    place[moving] = travel
    # Off the fold, on the side of the snap.
    little = 1e-4 * full
    if state >> other & 1:
        little = -min(little, 0.5 * (full - travel))
    else:
        little = min(little, 0.5 * travel)
    place[moving] -= little
    place[other] += little
    then = _flow(cells, full, place, step)
    if then < 0:
        return -1
    after = 0
    for i in range(n):
        if place[i] == full:
            after |= 1 << i
    return then << n | after


@kernel
def _landing(
    cells: Floats, ends: Floats, full: float, state: int, moving: int, travel: float, other: int
) -> tuple[int, float]:
    """Landing node of a chain, and the distance of its force to a third critical force [N].

    The cell that switches, `other`, takes the travel of `moving` [m] if it was at 0, or gives its
    own. The node is -1 where two computations differ.
    """
    n = len(ends)
    if state >> other & 1:
        give, take, gives, takes = other, moving, full, travel
        after = state & ~(1 << other) | 1 << moving
    else:
        give, take, gives, takes = moving, other, travel, 0.0
        after = state
    node = other << n | after
    if n == 2:
        return node, np.inf
    low, high = _limits(ends, after, other, other)
    force = force_at(of_row(cells[other]), travel)[0]
    clear = min(abs(force - low), abs(high - force))
    if low < force < high and _undisturbed(cells, ends, state, give, take, gives, takes):
        return node, clear
    coarse = _flowed(cells, full, state, moving, travel, other, _COARSE * full)
    fine = _flowed(cells, full, state, moving, travel, other, _FINE * full)
    if coarse < 0 or coarse != fine:
        return -1, clear
    moving, after = fine >> n, fine & ((1 << n) - 1)
    low, high = _limits(ends, after, moving, moving)
    force = force_at(of_row(cells[moving]), travel)[0]
    return fine, min(clear, abs(force - low), abs(high - force))


@kernel
def _by_stroke(cells: Floats, ends: Floats, slip: float, up: Ints, down: Ints) -> float:
    """Fill the targets of all nodes after vertices; returns the clearance, -1 without proof."""
    # One function: every node adds to the same list of waiting nodes.
    n = len(ends)
    full, clear = full_travel(of_row(cells[0])), np.inf
    waiting, count = np.empty(len(up), np.int64), 0
    for vertex in range(n << n, (n + 1) << n):
        for node in (up[vertex], down[vertex]):
            if node >= 0 and up[node] == NONE:
                up[node] = END
                waiting[count] = node
                count += 1
    while count > 0:
        count -= 1
        node = waiting[count]
        moving, state = node >> n, node & ((1 << n) - 1)
        empty, held = _leader(ends, state, moving, 0), _leader(ends, state, moving, 1)
        for rises in (True, False):
            other, own = (held, ends[moving, 1]) if rises else (empty, ends[moving, 0])
            force = own
            if other >= 0:
                force = max(own, ends[other, 1]) if rises else min(own, ends[other, 0])
            # It arrives at its own stop before another cell switches.
            target = n << n | (state | 1 << moving if rises else state)
            if other >= 0 and force != own:
                travel = 0.0
                if n > 2:
                    cell = of_row(cells[moving])
                    travel = travel_at(cell, force, ends[moving, 0], ends[moving, 1])
                target, room = _landing(cells, ends, full, state, moving, travel, other)
                clear = min(clear, room)
                if target < 0 or room <= slip:
                    return -1.0
                if up[target] == NONE:
                    up[target] = END
                    waiting[count] = target
                    count += 1
            if rises:
                up[node] = target
            else:
                down[node] = target
    return clear


@kernel
def graph_of(cells: Floats, ends: Floats, drive: int, slip: float, up: Ints, down: Ints) -> float:
    """Targets of every node of a chain as the drive rises, and as it falls.

    A node is the number of the cell in transit, N if none is, times 2^N, and the bits of the cells
    at 1. Cells are proved concave, of one full travel, and no two end forces tie. Returned is by
    how much a force in a snap could differ before it lands elsewhere [N]; -1 if it is not proved.
    """
    n = len(ends)
    up[:], down[:] = NONE, NONE
    for state in range(1 << n):
        empty, held = _leader(ends, state, -1, 0), _leader(ends, state, -1, 1)
        if empty >= 0 and held >= 0 and ends[held, 1] > ends[empty, 0]:
            continue
        vertex = n << n | state
        # By force a cell goes from stop to stop; by stroke it is in transit first.
        if drive == FORCE:
            up[vertex] = END if empty < 0 else vertex | 1 << empty
            down[vertex] = END if held < 0 else vertex & ~(1 << held)
        else:
            up[vertex] = END if empty < 0 else empty << n | state
            down[vertex] = END if held < 0 else held << n | state & ~(1 << held)
    if drive == FORCE:
        return np.inf
    return _by_stroke(cells, ends, slip, up, down)


@kernel
def _nearest(ends: Floats) -> tuple[float, float]:
    """Smallest distances of the end forces of two cells, at all ends and at one end [N]."""
    nearest, apart = np.inf, np.inf
    for i in range(len(ends)):
        for j in range(i):
            apart = min(apart, abs(ends[i, 0] - ends[j, 0]), abs(ends[i, 1] - ends[j, 1]))
            nearest = min(nearest, abs(ends[i, 0] - ends[j, 1]), abs(ends[i, 1] - ends[j, 0]))
    return min(nearest, apart), apart


@entry(_EACH, "numbers")
def _classify(
    numbers: Floats, drive: int, key: Ints, cycle: Ints, gap: Floats, decided: Ints
) -> None:
    n = numbers.shape[1]
    size = (n + 1) << n
    up, down = np.empty(size, np.int64), np.empty(size, np.int64)
    cells, ends = np.empty((n, 6)), np.empty((n, 2))
    loading, unloading = np.empty(n, np.int64), np.empty(n, np.int64)
    own = np.arange(n, dtype=np.int64)
    for k in range(len(numbers)):
        key[k], cycle[k], gap[k, 0], gap[k, 1] = -1, -1, 0.0, 0.0
        decided[k] = NOT_PROVED
        proved, scale, longest, least = True, 0.0, 0.0, np.inf
        for i in range(n):
            cell = of_row(numbers[k, i])
            proved = proved and certify(cell, 0.0)
            if not proved:
                break
            ends[i, 0], ends[i, 1] = end_forces(cell)
            scale = max(scale, abs(ends[i, 0]), abs(ends[i, 1]))
            travel = full_travel(cell)
            longest, least = max(longest, travel), min(least, travel)
        if not proved or not same_travel(longest, least):
            continue
        rank(ends[:, 0], own, loading)
        rank(-ends[:, 1], own, unloading)
        nearest, apart = _nearest(ends)
        slip = TIED * scale
        decided[k] = TIES
        if nearest <= slip:
            continue
        code = 0
        for i in range(n):
            code = code * n + loading[i]
        for i in range(n):
            code = code * n + unloading[i]
        cycle[k], gap[k, 1] = code, apart / scale
        # Cells by rising F0: the force in a chain does not depend on their places.
        for i in range(n):
            cells[i] = numbers[k, loading[i]]
        for i in range(n):
            ends[i, 0], ends[i, 1] = end_forces(of_row(cells[i]))
        clear = graph_of(cells, ends, drive, slip, up, down)
        if clear < 0.0:
            decided[k] = WAKES
            continue
        decided[k] = DECIDED
        gap[k, 0] = min(nearest, clear) / scale
        first, second = 1, 1
        for node in range(size):
            both = (up[node] + 2) * (size + 2) + down[node] + 2
            first = (first * _FACTORS[0] + both) % _PRIMES[0]
            second = (second * _FACTORS[1] + both) % _PRIMES[1]
        key[k] = first << 31 | second


class KeyCounts:
    """Counts of keys, and the design with the largest gap of each; for any number of designs."""

    def __init__(self, most: int):
        self._most, self._gap = most, np.zeros(0)
        self._key, self._count, self._where = np.zeros((3, 0), np.int64)

    def add(self, key: Ints, gap: Floats, first: int) -> None:
        """Count keys (m,) of the designs from number `first` on, without negative ones.

        Raises:
            ValueError: there are too many different ones.
        """
        there = np.flatnonzero(key >= 0)
        key, gap = np.append(self._key, key[there]), np.append(self._gap, gap[there])
        count = np.append(self._count, np.ones_like(there))
        where = np.append(self._where, first + there)
        # Stable: for equal gaps the first design is kept.
        order = np.lexsort((-gap, key))
        self._key, begin = np.unique(key[order], return_index=True)
        if len(begin) > self._most:
            raise InputError(
                f"there are more than {self._most} different graphs: take fewer cells."
            )
        self._gap, self._where = gap[order][begin], where[order][begin]
        self._count = np.add.reduceat(count[order], begin)

    @property
    def rows(self) -> list[tuple[int, int, float, int]]:
        """(key, count, largest gap, design with this gap), by rising key."""
        columns = (self._key, self._count, self._gap, self._where)
        return list(zip(*(column.tolist() for column in columns), strict=True))


@entry(1e-4, "ends")
def _graph(cells: Floats, ends: Floats, drive: int, up: Ints, down: Ints) -> float:
    return graph_of(cells, ends, drive, TIED * np.max(np.abs(ends)), up, down)


# From, to, direction of the drive, and whether the chain snaps on the way.
Way = tuple[str, str, int, bool]


def closed_graph(numbers: Floats, drive: int) -> tuple[Way, ...]:
    """Transitions of a chain that `classed` has decided; cells (N, 6) are the fields of `Simple`.

    Nodes are named by the phases of their cells, inner first, "-" for one in transit.
    """
    cells = np.ascontiguousarray(numbers, float)
    return _ways(cells, proved_ends(cells)[0], drive)


def graph_by_ends(ends: Floats, drive: int) -> tuple[Way, ...]:
    """The same of concave cells of which nothing but F0 and F1, (N, 2), are known [N], all
    different.

    Raises:
        ValueError: three cells or more under a stroke, where a snap may land by more than these.
    """
    if drive == STROKE and len(ends) > 2:
        raise InputError(f"{len(ends)} cells under a stroke: must be 2, or driven by a force.")
    return _ways(np.ones((len(ends), 6)) * 0.5, np.ascontiguousarray(ends, float), drive)


def _ways(cells: Floats, ends: Floats, drive: int) -> tuple[Way, ...]:
    n = len(ends)
    up, down = np.empty((2, (n + 1) << n), np.int64)
    _graph(cells, ends, drive, up, down)
    ways: list[Way] = []
    for direction, targets in ((+1, up), (-1, down)):
        for node in np.flatnonzero(targets >= 0).tolist():
            target = int(targets[node])
            # By stroke a transition that begins or ends at a vertex is reversible.
            snaps = drive == FORCE or (node >> n < n and target >> n < n)
            ways.append((_label(node, n), _label(target, n), direction, snaps))
    return tuple(ways)


def _label(node: int, n: int) -> str:
    phases = [str(node >> cell & 1) for cell in range(n)]
    if node >> n < n:
        phases[node >> n] = "-"
    return "".join(phases)


def classed(numbers: Floats, drive: int) -> tuple[Ints, Ints, Floats, Ints]:
    """Graph keys and cycles of many chains at once.

    Args:
        numbers: (m, N, 6) cells as the fields of `Simple`, inner first.
        drive: STROKE or FORCE.

    Returns:
        (m,) keys of the graphs, equal where graphs are, cells taken by rising F0, or -1; (m,)
        orders of loading and of unloading, the cells' numbers as digits of base N, or -1; (m, 2)
        smallest change of a force, over the largest force, that changes the graph, or the cycle;
        (m,) DECIDED, or why there is no key: NOT_PROVED, TIES, WAKES.

    Raises:
        ValueError: more cells than `MOST_CELLS`.
    """
    m, n = numbers.shape[:2]
    if n > MOST_CELLS:
        raise InputError(f"{n} cells: must be at most {MOST_CELLS}.")
    key, cycle, decided = np.empty((3, m), np.int64)
    gap = np.empty((m, 2))
    _classify(np.ascontiguousarray(numbers), drive, key, cycle, gap, decided)
    return key, cycle, gap, decided
