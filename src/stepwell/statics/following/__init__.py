"""Following the local minimum event by event: compiled kernels, and what they keep."""

from stepwell.statics.following.branch import drive_of, inverse_slope
from stepwell.statics.following.certificate import (
    ENERGY,
    EQUILIBRIUM,
    FORCE_SLACK,
    KEPT,
    STABILITY,
    audit,
)
from stepwell.statics.following.follow import FREE, HELD, State, held_range
from stepwell.statics.following.pieces import (
    MOST_PIECES,
    NO_FORCE,
    Pieces,
    cut,
    find_piece,
    force_scale,
)
from stepwell.statics.following.sample import count_samples, sample

__all__ = [
    "ENERGY",
    "EQUILIBRIUM",
    "FORCE_SLACK",
    "FREE",
    "HELD",
    "KEPT",
    "MOST_PIECES",
    "NO_FORCE",
    "STABILITY",
    "Pieces",
    "State",
    "audit",
    "count_samples",
    "cut",
    "drive_of",
    "find_piece",
    "force_scale",
    "held_range",
    "inverse_slope",
    "sample",
]
