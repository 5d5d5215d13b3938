"""What a transition graph is made of: where a chain can stand, and ways from there to elsewhere."""

from dataclasses import dataclass
from enum import Enum

from stepwell.base import ByValue, number


class TransitionKind(Enum):
    """How a chain gets from one node to the next."""

    SWITCH = "a cell arrives in a phase or leaves it; turning back undoes it"
    SNAP = "the chain jumps; turning back does not undo it"


@dataclass(frozen=True, slots=True, eq=False)
class Node(ByValue):
    """Stable equilibria with every cell in the same phase or in transit, one after another.

    A node with no cell in transit is a *vertex*. Under a rigid actuator one with every cell at a
    stop has one stroke and a range of forces; all others have a range of strokes.

    Attributes:
        label: its name in the graph: `state`, numbered where several nodes share it.
        state: one character a cell, inner first: the number of its phase, or - for one in transit.
        low, high: the drives between which it exists [m], or [N] under force control.
        force_low, force_high: the actuator's force λ there [N].
        travel_low, travel_high: (N,) travels there [m].
        branch: number of the branch it lies on; nodes of one branch lead to each other and
            back without a snap.
    """

    label: str
    state: str
    low: float
    high: float
    force_low: float
    force_high: float
    travel_low: tuple[float, ...]
    travel_high: tuple[float, ...]
    branch: int

    @property
    def is_vertex(self) -> bool:
        """Whether every cell stands in a phase."""
        return "-" not in self.state

    @property
    def level(self) -> int:
        """The sum of the phases of a vertex: how many cells are at 1 where all have two."""
        return sum(map(int, self.state))

    def __repr__(self):
        drives = f"{number(self.low)} to {number(self.high)}"
        return f"Node({self.label}: drive {drives}, branch {self.branch})"


@dataclass(frozen=True, slots=True, eq=False)
class Transition(ByValue):
    """What happens where a node ends.

    Attributes:
        kind: a switch or a snap.
        direction: +1 where the drive rises, -1 where it falls.
        drive: where [m], or [N] under force control.
        cells: those whose phase differs before and after, or that are in transit on either side of
            a snap.
        released: energy that a snap turns into heat [J].
        tie: whether another outcome was closer than the tolerance.
    """

    kind: TransitionKind
    direction: int
    drive: float
    cells: tuple[int, ...]
    released: float = 0.0
    tie: bool = False

    def __repr__(self):
        way = "up" if self.direction > 0 else "down"
        return f"Transition({self.kind.name} {way} at {number(self.drive)}, cells {self.cells})"
