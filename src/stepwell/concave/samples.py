"""Closed-form evaluation of Monte Carlo samples within tolerances of a nominal design."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepwell.base import Floats, Ints
from stepwell.concave.cell import Simple, force_at, full_travel, of_row, simple
from stepwell.concave.certificate import certify, end_forces
from stepwell.concave.sorting import TIED, rank, same_travel
from stepwell.kernels import entry, in_blocks, kernel, leaf, record
from stepwell.mechanism import Chain

Verdicts = NDArray[np.int8]

# Verdicts.
ASK, DOES, OTHER, TIE = 0, 1, 2, 3

# How the actuator drives the chain.
RIGID, COMPLIANT, FORCE = 0, 1, 2

_BLOCK = 20_000  # cells in one block of a core


@entry()
def in_disc(radius: float, u: float, v: float) -> tuple[float, float]:
    """A point uniformly distributed over a disc [m], from two numbers uniform over 0..1."""
    away, angle = radius * np.sqrt(u), 2.0 * np.pi * v
    return away * math.cos(angle), away * math.sin(angle)


@entry(2e-6, "numbers")
def in_discs(radius: Floats, numbers: Floats, out: Floats) -> None:
    """`in_disc` of (k,) radii [m] and (m, 2 k) numbers, into (m, k, 2)."""
    for sample in range(len(numbers)):
        for k in range(out.shape[1]):
            place = in_disc(radius[k], numbers[sample, 2 * k], numbers[sample, 2 * k + 1])
            out[sample, k, 0], out[sample, k, 1] = place


@kernel
def _sampled_cell(draw: Floats, cells: Floats, spread: Floats, i: int) -> tuple[Simple, float]:
    """Cell i of one sample, and its friction [N]; the columns are those of `Draws`."""
    n = len(cells)
    dx, dy = cells[i, 0], cells[i, 1]
    if spread[i, 0] > 0.0:
        px, py = in_disc(spread[i, 0], draw[4 * i], draw[4 * i + 1])
        qx, qy = in_disc(spread[i, 0], draw[4 * i + 2], draw[4 * i + 3])
        dx, dy = dx + qx - px, dy + qy - py
    made = Simple(
        dx,
        dy,
        cells[i, 2] * (1.0 + spread[i, 1] * draw[4 * n + i]),
        cells[i, 3] * (1.0 + spread[i, 2] * draw[5 * n + i]),
        cells[i, 4] + spread[i, 3] * (2.0 * draw[6 * n + i] - 1.0),
        cells[i, 5],
    )
    return made, cells[i, 6] + spread[i, 4] * draw[7 * n + i]


@entry(6e-6, "draws")
def _sampled_cells(draws: Floats, cells: Floats, spread: Floats, out: Floats) -> None:
    for sample in range(len(draws)):
        for i in range(len(cells)):
            made, _ = _sampled_cell(draws[sample], cells, spread, i)
            out[sample, i, 0], out[sample, i, 1] = made.dx, made.dy
            out[sample, i, 2], out[sample, i, 3] = made.stiffness, made.rest
            out[sample, i, 4], out[sample, i, 5] = made.lever, made.sin_limit


def sampled_cells(draws: Floats, numbers: Floats, spread: Floats) -> Floats:
    """(m, N, 6) cells of m samples, from the nominal cells (N, 6), the fields of `Simple`.

    Draws (m, 8 N) have one sample per row, in the layout of `Draws`; `spread` (N, 5) or wider has
    the tolerances of each cell: anchor, stiffness, rest length, lever and friction.
    """
    out = np.empty((len(draws), *numbers.shape))
    cells = np.column_stack([numbers, np.zeros(len(numbers))])
    _sampled_cells(np.ascontiguousarray(draws), cells, spread, out)
    return out


@kernel
def _stays_off_stops(
    made: list[Simple], friction: Floats, full: Floats, key: Floats, order: Ints
) -> bool:
    """Proof that no cell that gives travel back in a snap reaches its other stop.

    While cell j loads, the cells at 1 give back at most the travel that j still needs when they
    leave their stops. That is less than the shortest of their travels, S_min, if at the travel
    S_j - S_min the force that moves j is still above all critical forces of these cells. Unloading
    is the mirror image.
    """
    for side in range(2):
        first: int = order[side, 0]
        shortest, release = full[first], key[1 - side, first]
        for place in range(1, len(full)):
            j: int = order[side, place]
            if full[j] > shortest:
                force = force_at(made[j], shortest if side else full[j] - shortest)[0]
                if not (-force if side else force) + friction[j] > -release:
                    return False
            shortest, release = min(shortest, full[j]), min(release, key[1 - side, j])
    return True


@leaf
def _orders_as_number(order: Ints, target: Ints) -> tuple[int, bool]:
    """Both orders as digits of base N, and whether they are the target orders."""
    number, right = 0, True
    for side in range(2):
        for place in range(order.shape[1]):
            number = number * order.shape[1] + order[side, place]
            right = right and order[side, place] == target[side, place]
    return number, right


@leaf
def _smallest_gap(key: Floats, target: Ints, order: Ints, least: float) -> tuple[float, int, bool]:
    """Smallest gap of neighbours in the target order, its place, and whether two forces tie."""
    smallest, where, tie = np.inf, 0, False
    pairs = order.shape[1] - 1
    for side in range(2):
        for place in range(pairs):
            before, after = order[side, place], order[side, place + 1]
            tie = tie or key[side, after] - key[side, before] <= least
            apart = key[side, target[side, place + 1]] - key[side, target[side, place]]
            if apart < smallest:
                smallest, where = apart, side * pairs + place
    return smallest, where, tie


@leaf
def _count_wrong(key: Floats, target: Ints, wrong: Ints) -> None:
    """Add 1 to each pair of neighbours in the target orders that is in the other order."""
    for side in range(2):
        for place in range(wrong.shape[1]):
            first, second = target[side, place], target[side, place + 1]
            wrong[side, place] += key[side, second] < key[side, first]


@record
class SampleVerdicts(NamedTuple):
    """Results of `judge_samples` for m samples of N cells.

    Attributes:
        verdict: (m,) ASK where the closed form is not proved.
        does: (m,) both orders as digits of base N; overflows for long chains.
        gap: (m,) smallest gap [N] between neighbours of the target orders, negative where two of
            them are in the other order; infinite for a single cell.
        wrong: (2, N - 1) number of samples with a pair of neighbours in the other order.
        narrowest: (2, N - 1) number of samples in which the gap of a pair is the smallest.
    """

    verdict: Verdicts
    does: Ints
    gap: Floats
    wrong: Ints
    narrowest: Ints


@entry(6e-6, "draws")
def judge_samples(
    draws: Floats, cells: Floats, spread: Floats, target: Ints, drive: int, out: SampleVerdicts
) -> None:
    """Verdict on every sample by the order of the critical forces of its cells.

    Cells of falling force load in rising F0 + f and unload in falling F1 - f, f their friction:
    while one of them moves, the actuator's force stays below the critical force of the next, and
    the moving cells lack less than one full travel in sum, so none returns to its other stop. That
    needs equal travels, or `_stays_off_stops` under a rigid actuator. A prescribed force needs
    neither, because the cells do not interact.

    Draws and spread are as for `sampled_cells`, cells (N, 7) end with their friction, and `target`
    has (2, N) cells in order; `wrong` and `narrowest` of `out` are added to.
    """
    # The arrays are made once for all samples.
    n = len(cells)
    made = [of_row(cells[0]) for _ in range(n)]
    friction, full = np.empty(n), np.empty(n)
    key, order = np.empty((2, n)), np.empty((2, n), np.int64)
    for sample in range(len(draws)):
        proved = True
        scale, longest, least = 0.0, 0.0, np.inf
        for i in range(n):
            made[i], friction[i] = _sampled_cell(draws[sample], cells, spread, i)
            proved = proved and certify(made[i], 0.0)
            force_0, force_1 = end_forces(made[i])
            key[0, i], key[1, i] = force_0 + friction[i], friction[i] - force_1
            full[i] = full_travel(made[i])
            scale = max(scale, abs(force_0), abs(force_1), friction[i])
            longest, least = max(longest, full[i]), min(least, full[i])
        for side in range(2):
            rank(key[side], target[side], order[side])
        out.does[sample], right = _orders_as_number(order, target)
        out.gap[sample], where, tie = _smallest_gap(key, target, order, TIED * scale)
        if proved and drive != FORCE and not same_travel(longest, least):
            proved = drive == RIGID and _stays_off_stops(made, friction, full, key, order)
        if not proved:
            out.verdict[sample] = ASK
            continue
        out.verdict[sample] = TIE if tie else DOES if right else OTHER
        if n > 1:
            out.narrowest[where // (n - 1), where % (n - 1)] += 1
        if out.verdict[sample] == OTHER:
            _count_wrong(key, target, out.wrong)


@dataclass(frozen=True, slots=True)
class DrawJudge:
    """Evaluation of many samples of one chain against a target cycle."""

    cells: Floats  # (N, 7) as `judge_samples` takes them
    spread: Floats  # (N, 5) or wider
    target: Ints  # (2, N)
    drive: int

    @classmethod
    def of(cls, chain: Chain, spread: Floats, target: Ints) -> "DrawJudge | None":
        """The judge of a chain; None where a cell has several bands, a nonlinear law or a load."""
        cells: list[list[float]] = []
        for cell in chain.cells:
            numbers = simple(replace(cell, friction=0.0))
            if numbers is None:
                return None
            cells.append([*numbers, cell.friction])
        drive = {0.0: FORCE, math.inf: RIGID}.get(chain.actuator_stiffness, COMPLIANT)
        return cls(np.array(cells), spread, target, drive)

    def __call__(self, draws: Floats) -> SampleVerdicts:
        """The verdicts on samples (m, 8 N)."""
        m, n = len(draws), len(self.cells)
        verdict, does, gap = np.empty(m, np.int8), np.empty(m, np.int64), np.empty(m)
        counts: list[Ints] = []

        def judge(begin: int, end: int) -> None:
            counts_here = np.zeros((2, 2, n - 1), np.int64)
            here = slice(begin, end)
            out = SampleVerdicts(verdict[here], does[here], gap[here], *counts_here)
            judge_samples(draws[here], self.cells, self.spread, self.target, self.drive, out)
            counts.append(counts_here)

        in_blocks(judge, m, judge_samples.block(max(1, _BLOCK // n), draws))
        wrong, narrowest = sum(counts, np.zeros((2, 2, n - 1), np.int64))
        return SampleVerdicts(verdict, does, gap, wrong, narrowest)
