"""Other placements in the wanted orders, where the best one does not do what is wanted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.concave import TIED
from stepwell.design.orders import Target
from stepwell.design.placement import Candidates, joined, measured
from stepwell.design.synthesis.attempt import Attempt

_DRAWN = 5000  # placements of each attempt
_NEAR = 200  # places round the best one of each cell
# Cells of the chains that the engine looks at in all: some seconds.
_LOOKED_AT = 2400


def another(
    target: Target, attempts: list[Attempt], actuator_stiffness: float, seed: int
) -> tuple[Attempt | None, int]:
    """The surest of some random placements that does what is wanted by the engine.

    Two orders tell what is surely reached. Where more than that is reached, since a cell overtakes
    another in a snap, it is not by the end forces, so placements are drawn at random from
    those in the wanted orders, and looked at from the surest on.

    Returns:
        An attempt that has it as its best one, and how many were looked at.
    """
    rng = np.random.default_rng(seed)
    pool: list[tuple[float, int, Attempt, Candidates]] = []
    for attempt in [one for given in attempts for one in (given, _near(given, rng))]:
        if not attempt.tables or not all(len(table.q) for table in attempt.tables):
            continue
        table = joined(attempt.tables)
        picks = _drawn(attempt, rng)
        sure = _surety(attempt, table, picks)
        for row in np.flatnonzero(sure > -np.inf).tolist():
            pool.append((float(sure[row]), len(pool), attempt, table.take(picks[row])))
    pool.sort(key=lambda one: (-one[0], one[1]))
    most = _LOOKED_AT // target.cells
    for looked_at, (_, _, attempt, cells) in enumerate(pool[:most], 1):
        placed = replace(attempt, best=measured(attempt.rule, attempt.orders, cells))
        if _does(target, placed, actuator_stiffness):
            finer = placed.refined()
            return (finer if _does(target, finer, actuator_stiffness) else placed), looked_at
    return None, min(most, len(pool))


def _does(target: Target, attempt: Attempt, actuator_stiffness: float) -> bool:
    return not target.fault(attempt.chain(actuator_stiffness, ""), attempt.orders)


def _near(attempt: Attempt, rng: np.random.Generator) -> Attempt:
    """The attempt with tables of places at random round its best ones, near and far."""
    if attempt.best is None or attempt.holes is not None:
        return replace(attempt, tables=[])
    tables: list[Candidates] = []
    for region, q, kind in zip(
        attempt.regions, attempt.best.cells.q, attempt.best.cells.kind, strict=True
    ):
        away = attempt.pitch * rng.uniform(0.01, 4.0, (_NEAR, 1)) * rng.standard_normal((_NEAR, 2))
        tables.append(attempt.rule.these(region.clamped(q + away), np.full(_NEAR, kind)))
    return replace(attempt, tables=tables, owner=tuple(range(len(tables))))


def _drawn(attempt: Attempt, rng: np.random.Generator) -> Ints:
    """(m, N) numbers of candidates, each cell's from its own table."""
    sizes = np.array([len(table.q) for table in attempt.tables])
    first = np.cumsum(sizes) - sizes
    owner = np.array(attempt.owner)
    return first[owner] + rng.integers(sizes[owner], size=(_DRAWN, len(owner)))


def _surety(attempt: Attempt, table: Candidates, picks: Ints) -> Floats:
    """(m,) logarithm of the chance that no gap closes; -inf where an order is not met."""
    from scipy.special import log_ndtr  # pyright: ignore[reportMissingTypeStubs]

    total = np.zeros(len(picks))
    least = TIED * float(np.max(np.abs(table.force)))
    for end, order in enumerate(attempt.orders.rising):
        at = picks[:, list(order)]
        gap = np.diff(table.force[at, end], axis=1)
        near = attempt.rule.combined(table.up[at[:, :-1], end], table.down[at[:, 1:], end])
        # In the worst case nothing is taken of a gap by no displacement.
        ratio = np.divide(gap, near, out=gap.copy(), where=near > 0)
        total += np.sum(np.where(gap > least, log_ndtr(ratio), -np.inf), axis=1)
    return total
