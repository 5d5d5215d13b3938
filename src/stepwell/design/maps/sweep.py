"""The map's inner loop: many designs of one chain, each sorted in closed form."""

import numpy as np

from stepwell.concave import (
    Simple,
    certify,
    end_forces,
    full_travel,
    same_travel,
    travel_at,
)
from stepwell.kernels import entry, kernel

# Of a cell in the rows below: the fields of `Simple`, and then this one.
FRICTION = 6


@entry(3e-6, "values", "base")
def sweep(values, base, rows, columns, turned, run, orders, strokes, snaps, gap, monostable):
    """What m designs do when a rigid actuator loads and unloads them once, where it is proved.

    It is proved where all cells are certified and without friction and have one full travel (a
    cell that gives travel back in a snap gives back less than that, and so never reaches its
    other stop), or where there are two cells, of which neither has to give back all it has.

    From the rules (a cell at 0 stays while F0 >= λ, one at 1 while F1 <= λ, one in transit has
    F = λ, two in transit with falling forces are unstable):
    - loading: cells leave 0 by ascending F0. Where cell j moves, λ = F_j(s) falls from F0_j, and
      the full cells hold their stops while F1 <= λ: for ever if F1_j is the largest, else up to
      F_j(s*) = F1_i for the largest F1_i of a full cell, at the stroke of all full cells and s*.
      There i comes off its stop, two cells are in transit, and the chain snaps: j runs to its
      stop, i gives back as much and then finishes alone.
    - unloading: the same picture upside down. Cells leave 1 by descending F1; j snaps where
      F_j(s*) = F0_i for the smallest F0_i of an empty cell, at the stroke of the cells that are
      still full and s*.
    Equal forces, which no rule decides, go to the inner cell first.

    Args:
        values: (m, 2) what is added to two of the numbers of `base`.
        base: (n, 7) a cell a row: the fields of `Simple`, and its friction.
        rows, columns: (2,) int, which two.
        turned: (c,) int, rows whose numbers change; all others are certified already.
        run: (m,) int, out: designs that follow each other and do the same, by number; -1 where
            it is not proved, and nothing else is touched.
        orders: (m, 2, n) int, out: of each run, cells in the order in which they load, and unload.
        strokes: (2, m) out: stroke [m] of the first snap while loading and while unloading, NaN
            where there is none.
        snaps: (2, m) int, out: how many cells snap.
        gap: (m,) out: smallest difference of two F0 or of two F1 [N], infinite for one cell.
        monostable: (m,) bool, out: whether a turned cell is stable in one state only.

    Returns:
        How many runs there are.
    """
    n = len(base)
    cells = base.copy()
    # Both fall in the order of motion: F0 and -F1 by cell.
    force = np.empty((2, n))
    full = np.empty(n)
    order = np.empty((2, n), np.int64)
    for c in range(n):
        order[0, c] = order[1, c] = c
        force[0, c], force[1, c], full[c] = numbers(cells, c)
    runs = 0
    same = False
    for i in range(len(values)):
        run[i] = -1
        for k in range(2):
            cells[rows[k], columns[k]] = base[rows[k], columns[k]]
        for k in range(2):
            cells[rows[k], columns[k]] += values[i, k]
        holds = True
        lone = False
        for c in turned:
            holds = cells[c, FRICTION] <= 0.0 and certify(simple_of(cells, c), 0.0)
            if not holds:
                break
            force[0, c], force[1, c], full[c] = numbers(cells, c)
            lone = lone or force[0, c] <= 0.0 or force[1, c] <= 0.0
        if not holds:
            continue
        most, least = full[0], full[0]
        for c in range(1, n):
            most, least = max(most, full[c]), min(least, full[c])
        equal = same_travel(most, least)
        if not equal and n != 2:
            continue
        closest = np.inf
        for side in range(2):
            moved = sort(order, force, side)
            same = same and not moved
            stroke, count = np.nan, 0
            # Of the cells that have moved: the largest F1 where they load, -F0 where they unload.
            pull = -np.inf
            for k in range(n):
                c = order[side, k]
                if k > 0:
                    closest = min(closest, force[side, c] - force[side, order[side, k - 1]])
                back = -force[1 - side, c]
                if back < pull:
                    if count == 0:
                        level = pull if side == 0 else -pull
                        cell = simple_of(cells, c)
                        stroke = travel_at(cell, level, force[0, c], -force[1, c])
                        gives = full[c] - stroke if side == 0 else stroke
                        holds = holds and (equal or gives < full[order[side, 0]])
                        # The other cells that are full meanwhile.
                        for j in range(k if side == 0 else n - k - 1):
                            stroke += full[order[side, j if side == 0 else k + 1 + j]]
                    count += 1
                pull = max(pull, back)
            strokes[side, i] = stroke
            snaps[side, i] = count
        if not holds:
            continue
        if not same:
            for side in range(2):
                for k in range(n):
                    orders[runs, side, k] = order[side, k]
            runs += 1
            same = True
        run[i] = runs - 1
        gap[i] = closest
        monostable[i] = lone
    return runs


@entry(1e-5, "values", "turned")
def ends(values, base, rows, columns, turned, out):
    """F0 and F1 [N] of the cells in `turned`, (m, c, 2), proved or not; all else as in `sweep`."""
    cells = base.copy()
    for i in range(len(values)):
        for k in range(2):
            cells[rows[k], columns[k]] = base[rows[k], columns[k]]
        for k in range(2):
            cells[rows[k], columns[k]] += values[i, k]
        for k in range(len(turned)):
            out[i, k, 0], out[i, k, 1] = end_forces(simple_of(cells, turned[k]))


# Elements are looked up and not rows: in machine code a row is an object of its own.


@kernel
def simple_of(cells, c):
    """The cell in a row of numbers."""
    return Simple(cells[c, 0], cells[c, 1], cells[c, 2], cells[c, 3], cells[c, 4], cells[c, 5])


@kernel
def numbers(cells, c):
    """F0 [N], -F1 [N] and the full travel [m] of a cell."""
    cell = simple_of(cells, c)
    force_0, force_1 = end_forces(cell)
    return force_0, -force_1, full_travel(cell)


@kernel
def sort(order, force, side):
    """Put cells in ascending order of force, equal ones by number; whether any had to move.

    The order is mostly right, or nearly.
    """
    moved = False
    for k in range(1, order.shape[1]):
        c = order[side, k]
        own = force[side, c]
        j = k
        while j > 0:
            before = order[side, j - 1]
            if force[side, before] < own or (force[side, before] == own and before < c):
                break
            order[side, j] = before
            j -= 1
            moved = True
        order[side, j] = c
    return moved
