"""The closed form of concave cells, where it is proved: certificates, end forces, sorting."""

from stepwell.concave.certificate import (
    Simple,
    certify,
    closed,
    end_forces,
    push,
    simple,
    travel_at,
)
from stepwell.concave.certified import certified_within
from stepwell.concave.disc import concave_disc
from stepwell.concave.end_forces import end_force, end_forces_at, steepest
from stepwell.concave.end_grid import look
from stepwell.concave.samples import ASK, DOES, OTHER, TIE, Judge, in_disc
from stepwell.concave.sorted_chain import SortedChain
from stepwell.concave.sweep import decide, sweep

__all__ = [
    "ASK",
    "DOES",
    "OTHER",
    "TIE",
    "Judge",
    "Simple",
    "SortedChain",
    "certified_within",
    "certify",
    "closed",
    "concave_disc",
    "decide",
    "end_force",
    "end_forces",
    "end_forces_at",
    "in_disc",
    "look",
    "push",
    "simple",
    "steepest",
    "sweep",
    "travel_at",
]
