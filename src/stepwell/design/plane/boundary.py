"""A curve across which a chain does something else."""

from dataclasses import dataclass
from enum import Enum

from stepwell.base import Advised, ByValue, Floats

# Part of the axes at which a search stops.
RESOLVED = 1e-8


class BoundaryKind(Enum):
    """What a boundary of a map separates."""

    LOADING_ORDER = "the cells load in the other order on the other side"
    UNLOADING_ORDER = "the cells unload in the other order on the other side"
    PATHWAY = "the chain runs through other states on the other side"
    BISTABLE = "a cell has two stable states on one side and one on the other"


class Method(Advised):
    """How a boundary, or the nearest change of a chain, was found."""

    EXACT = (
        "exact",
        "in closed form, to rounding, and proved: nothing that is nearer, or beside it, was missed",
    )
    SEARCH = (
        "search",
        "asked of the engine place by place, then bisected: what comes and goes between two places "
        "is not seen. Look at `resolution` or `error`, and ask with a smaller reach or a finer "
        "search where that is too coarse",
    )


@dataclass(frozen=True, eq=False)
class Boundary(ByValue):
    """A curve in the plane of two parameters, across which the chain does something else.

    Attributes:
        kind: what it separates.
        points: (m, 2) along the curve, each column in the SI unit of its parameter.
        changes: what changes across it, in words.
        method: exact (the closed form's own curve, where two F0 or two F1 are equal or a stop
            is left) or a search (bisection of what the general engine does, along the edges of a
            grid).
        error: farthest a point is from the curve, as a part of the axes.
        parameters: names of the two parameters.
        units: their units.
        sequences: what the chain does on either side; words where that is no sequence.
    """

    kind: BoundaryKind
    points: Floats
    changes: str
    method: Method
    error: float
    parameters: tuple[str, str]
    units: tuple[str, str]
    sequences: tuple[str, str]

    def __repr__(self):
        return (
            f"Boundary({self.changes}; {len(self.points)} points, {self.method}, within "
            f"{self.error:.1g} of the axes)"
        )
