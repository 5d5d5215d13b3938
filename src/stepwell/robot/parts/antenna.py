"""An antenna: a hinged rod that, when something pushes it back, moves an anchor of a leg."""

from __future__ import annotations

import math
from dataclasses import dataclass

from stepwell.base import ByValue, InputError, Vec2, check


@dataclass(frozen=True, slots=True, eq=False)
class Antenna(ByValue):
    """A rod on a vertical hinge, coupled to the anchor p of one cell.

    Free, it rests at `angle`, held there by the pull of the band on the anchor. A contact
    turns it back by up to `swing`, and the anchor moves with it, in proportion, by up to
    `moves`.

    Args:
        name: what messages and figures call it.
        pivot: (x, y) of the hinge [m] from the body's origin.
        length: of the rod [m], > 0.
        angle: from straight ahead at rest [rad], between 0 and π; the antenna whose tip points
            to the right carries a negative one.
        leg, cell: the leg and the cell (index, 0 for the innermost, or name) whose anchor it
            moves.
        moves: displacement of that anchor p at full swing [m], in the cell's frame.
        swing: largest rotation [rad], > 0, towards the back.
        hook: length of the bent tip [m], >= 0.
        hook_angle: of the bent tip from the rod, towards the back [rad].
        mass: of the rod [kg], > 0.
        damping: of the hinge [N m s/rad], > 0.
        friction: Coulomb's coefficient between rod and walls, >= 0.
        connected: False leaves the rod but takes its lever off the anchor; a weak spring then
            holds the rod at rest. The control experiment.

    Raises:
        ValueError: a value out of range.

    Source: Kamp et al. 2024, Fig. 4, for the idea; the geometry is ours.
    """

    name: str
    pivot: Vec2
    length: float
    angle: float
    leg: str
    moves: Vec2
    cell: int | str = 0
    swing: float = 1.2
    hook: float = 0.0
    hook_angle: float = 1.3
    mass: float = 0.003
    damping: float = 2e-4
    friction: float = 0.15
    connected: bool = True

    def __post_init__(self):
        check.fields(self, check.vector, pivot="m", moves="m")
        check.fields(self, check.positive, length="m", swing="rad", mass="kg", damping="N m s/rad")
        check.fields(self, check.not_negative, friction="1", hook="m")
        check.fields(self, check.finite, angle="rad", hook_angle="rad")
        if not 0 < abs(self.angle) < math.pi:
            raise InputError(
                f"angle = {math.degrees(self.angle):.6g} deg of antenna {self.name!r}: must be "
                f"between 0 and 180 deg to the left, or their negatives to the right."
            )
        if math.hypot(*self.moves) == 0:
            raise InputError(
                f"moves = (0, 0) of antenna {self.name!r}: must be a displacement; to take the "
                f"lever off, set connected = False."
            )

    @property
    def side(self) -> int:
        """+1 for an antenna whose tip points to the left, -1 to the right."""
        return 1 if self.angle > 0 else -1

    @property
    def gear(self) -> float:
        """Displacement of the anchor per rotation [m/rad]."""
        return math.hypot(*self.moves) / self.swing
