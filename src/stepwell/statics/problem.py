"""A chain and its actuator as a problem for the follower."""

import math
from collections.abc import Sequence

import numpy as np

from stepwell.base import InputError, Ints
from stepwell.kernels import UNLIMITED
from stepwell.mechanism import FIRST, Chain, Laws, Sheets, mobilities_of, packed
from stepwell.statics.following import MOST_PIECES, Problem, cut, force_scale, spare_room
from stepwell.statics.outcome import StaticsError


def drive_weights(chain: Chain) -> tuple[float, float]:
    """(α, β) of the drive coordinate U = α Σ s_i + β λ."""
    stiffness = chain.actuator_stiffness
    if math.isinf(stiffness):
        return 1.0, 0.0
    return (0.0, 1.0) if stiffness == 0 else (1.0, 1.0 / stiffness)


def problem_of(
    chain: Chain, cells: tuple[Laws, Sheets] | None = None, prefer: Sequence[int] | None = None
) -> Problem:
    """The problem that a chain sets.

    Args:
        chain: the chain.
        cells: its packed cells, where they are at hand.
        prefer: cells by falling priority where two of them tie.

    Raises:
        ValueError: a `prefer` that does not name every cell once.
        StaticsError: a force that turns too often to follow.
    """
    laws, sheets = packed(chain.cells) if cells is None else cells
    pieces = cut(laws, sheets)
    counts = np.diff(pieces.of_sheet)
    worst = int(np.argmax(counts))
    if counts[worst] > MOST_PIECES:
        cell = int(np.searchsorted(np.unique(sheets.table[:, FIRST]), worst, side="right")) - 1
        raise StaticsError(
            f"the force of {chain.names[cell]} turns {counts[worst]} times over its travel, too "
            f"often to follow: smooth its table, or look for a band whose ends nearly meet."
        )
    effort = np.array([0, UNLIMITED])
    rank = _ranks(len(chain), prefer)
    scale = force_scale(laws, sheets, pieces)
    weights, mobility = drive_weights(chain), mobilities_of(chain.cells)
    room = spare_room(len(chain))
    return Problem(laws, sheets, pieces, *weights, scale, rank, mobility, effort, room)


def _ranks(cells: int, prefer: Sequence[int] | None) -> Ints:
    if prefer is None:
        # All alike: cells of constant force share the motion, else the innermost goes first.
        return np.zeros(cells, np.int64)
    order = [int(i) for i in prefer]
    if sorted(order) != list(range(cells)):
        raise InputError(
            f"prefer = {prefer!r}: must name each of the cells 0..{cells - 1} once, first the one "
            f"that goes first."
        )
    ranks = np.empty(cells, np.int64)
    ranks[order] = np.arange(cells)
    return ranks
