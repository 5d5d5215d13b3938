"""The claim that snaps can make robots jump, and why the paper's robot cannot."""

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from stepwell import base, files
from stepwell.base import GRAVITY, ByValue
from stepwell.paper.claims import Finding, claim, finding_of
from stepwell.robot import Robot

if TYPE_CHECKING:
    from stepwell.simulation import Jump

# A hop that is seen without instruments [m].
SEEN = 0.010


@dataclass(frozen=True, slots=True, eq=False)
class Lift(ByValue):
    """What all legs of a walking robot together could lift, at most.

    Attributes:
        weight: of the robot [N].
        forces: F0 of each cell, of all legs together, inner first [N].
        energy: of one snap of every leg [J].
    """

    weight: float
    forces: tuple[float, ...]
    energy: float

    @property
    def height(self) -> float:
        """Height to which that energy lifts the weight without any loss [m]."""
        return self.energy / self.weight


def lift_of(robot: Robot) -> Lift:
    """The largest lift of a robot that would stand on its chains, without any loss."""
    each = [[cell.force_0 for cell in leg.chain.levers] for leg in robot.legs]
    snaps = [
        max((one.released for one in leg.chain.cycle().snaps), default=0.0) for leg in robot.legs
    ]
    forces = tuple(map(sum, zip(*each, strict=True)))
    return Lift(robot.mass * GRAVITY, forces, sum(snaps))


@cache
def jump_of(name: str = "hopper") -> "Jump":
    """One jump of a shipped hopper."""
    from stepwell.simulation import jump

    return jump(files.load(f"preset:{name}").hopper)


@claim("Conclusion", "an outlook, no number", f"a hop of {base.to_unit(SEEN, 'mm'):g} mm or more")
def snap_energy_for_jumping() -> Finding:
    """The energy of snaps can be used for jumping."""
    lift, jump = lift_of(files.load("preset:robot-forward").robot), jump_of()
    hopper, first = jump.hopper, jump.first
    stiffness = hopper.chain.levers[0].bands[0].stiffness
    low, high = min(lift.forces), max(lift.forces)
    high_mm = base.to_unit(first.height, "mm")
    return finding_of(
        first.height >= SEEN,
        f"{high_mm:.0f} mm, simulated, by a hopper of ours; not the paper's robot",
        note=f"The paper's robot cannot: both legs together push with {low:.2f} and {high:.2f} N "
        f"against its weight of {lift.weight:.1f} N, and a snap of both sets free "
        f"{base.to_unit(lift.energy, 'mJ'):.1f} mJ, which lift it by "
        f"{base.to_unit(lift.height, 'mm'):.1f} mm. A jump needs another layout, the foot on the "
        f"middle block, a bistable cell before it and a cell that pulls behind it; "
        f"{hopper.copies} chains of {stiffness:.0f} N/m and "
        f"{base.to_unit(hopper.chain.full_travels[0], 'mm'):.0f} mm of travel throw up "
        f"{base.to_unit(hopper.mass, 'g'):.0f} g; {first.flow.efficiency:.0%} of "
        f"{base.to_unit(first.flow.released, 'mJ'):.0f} mJ flies. All numbers of the hopper are "
        f"assumed, and none was built.",
        otherwise="The hopper does not leave the floor.",
    )


JUMPING_CLAIMS = (snap_energy_for_jumping,)
