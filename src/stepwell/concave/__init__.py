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
from stepwell.concave.ends import end_force, end_forces_at
from stepwell.concave.nearest import concave_disc, nearest_of
from stepwell.concave.samples import ASK, DOES, OTHER, TIE, Judge, in_disc
from stepwell.concave.sift import sift
from stepwell.concave.sorted_chain import SortedChain

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
    "end_force",
    "end_forces",
    "end_forces_at",
    "in_disc",
    "nearest_of",
    "push",
    "sift",
    "simple",
    "travel_at",
]
