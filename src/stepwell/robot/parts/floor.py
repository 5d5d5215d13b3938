"""The floor: how it drags on the T-foot and how it holds the feet."""

from __future__ import annotations

from dataclasses import dataclass

from stepwell.base import ByValue, check


@dataclass(frozen=True, slots=True, eq=False)
class Floor(ByValue):
    """A level floor.

    Args:
        drag: force that pulls the robot along on its T-foot alone [N], >= 0.
        foot_friction: Coulomb's coefficient between a foot and the floor, > 0.
        gravity: [m/s²], >= 0; 0 hangs the robot in the air.

    Raises:
        ValueError: a value out of range.

    Source: the notes of Kamp et al. 2024: a drag of 0.39 N on MDF and 0.79 N on rubber.
    """

    drag: float = 0.39
    foot_friction: float = 0.5
    gravity: float = 9.81

    def __post_init__(self):
        object.__setattr__(self, "drag", check.not_negative("drag", self.drag, "N"))
        friction = check.positive("foot_friction", self.foot_friction, "1")
        object.__setattr__(self, "foot_friction", friction)
        object.__setattr__(self, "gravity", check.not_negative("gravity", self.gravity, "m/s²"))
