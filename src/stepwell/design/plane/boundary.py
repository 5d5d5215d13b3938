"""A curve across which a chain does something else."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from stepwell.base import ByValue

# Width [m] at which a search stops.
RESOLVED = 1e-9


class BoundaryKind(Enum):
    """What a boundary of the transition map separates."""

    LOADING_ORDER = "the cells load in the other order on the other side"
    UNLOADING_ORDER = "the cells unload in the other order on the other side"
    PATHWAY = "the chain runs through other states on the other side"
    BISTABLE = "the moved cell has two stable states on one side and one on the other"


@dataclass(frozen=True, eq=False)
class Boundary(ByValue):
    """A curve in the plane of an anchor q, across which the chain does something else.

    Attributes:
        kind: what it separates.
        points: (m, 2) along the curve [m].
        changes: what changes across it, in words.
        method: "exact" (the closed form's own curve) or "search" (bisection of what the general
            engine does, along the edges of a grid).
        error: farthest a point is from the curve [m].
    """

    kind: BoundaryKind
    points: NDArray[np.float64]
    changes: str
    method: str
    error: float

    def __repr__(self):
        return (
            f"Boundary({self.changes}; {len(self.points)} points, {self.method}, within "
            f"{self.error * 1e3:.1g} mm)"
        )
