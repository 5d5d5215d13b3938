"""A hopper as a value: a body on a chain of cells, one block of which is the foot."""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

from stepwell.base import ByValue, InputError, check, to_unit
from stepwell.mechanism import Cell, Chain, Load


class Task(StrEnum):
    """What the released energy moves."""

    JUMP = "jump"  # The foot stands on the floor and the body leaves it.
    THROW = "throw"  # The body is fixed and the block throws a ball.
    STRIKE = "strike"  # The body is fixed and the block strikes where its travel ends.


@dataclass(frozen=True, slots=True, eq=False)
class Springs(ByValue):
    """Bands or steel springs of all cells together; a `ValueError` refuses values out of range.

    Args:
        mass: of all springs [kg], > 0; part of the body's mass.
        stretch: largest length over rest length [1], > 1, at which a spring may be used.
        loss: fraction of the loading work that a full loop of the spring loses [1], 0 to below 1.
        origin: source of the springs' numbers, one line.
    """

    mass: float = 0.004
    stretch: float = 3.0
    loss: float = 0.0
    origin: str = "assumed"

    def __post_init__(self):
        check.fields(self, check.positive, mass="kg", stretch="1")
        check.fields(self, check.not_negative, loss="1")
        if self.stretch <= 1.0:
            raise InputError(f"stretch = {self.stretch:g}: must be > 1, a length over rest length.")
        if self.loss >= 1.0:
            raise InputError(f"loss = {to_unit(self.loss, '%'):g} %: must be < 100 %.")


@dataclass(frozen=True, slots=True, eq=False)
class Actuator(ByValue):
    """The slow linear actuator between body and rod; a `ValueError` refuses values out of range.

    Args:
        force: largest force in either direction [N], > 0.
        speed: of the rod [m/s], > 0.
        stiffness: of screw and rod [N/m], > 0.
    """

    force: float = 50.0
    speed: float = 0.020
    stiffness: float = 1e5

    def __post_init__(self):
        check.fields(self, check.positive, force="N", speed="m/s", stiffness="N/m")


@dataclass(frozen=True, slots=True, eq=False)
class Hopper(ByValue):
    """A body, a chain of cells below it, and a block of the chain that is the foot.

    The innermost block belongs to the body. The first `foot_after` cells join it to the foot, the
    other cells join the foot to the rod of the actuator, which belongs to the body too. A stroke
    of the rod stores energy until the foot snaps away from the body. On the floor this throws up
    the body; with the body fixed, the foot throws a ball or strikes.

    Args:
        chain: two lever cells or more, inner first, driven by a prescribed stroke.
        body_mass: of all but the foot [kg], the rod and other blocks included, > 0.
        foot_mass: of the foot, the pusher or the hammer [kg], > 0.
        foot_after: number of cells between body and foot, 1 to all but one.
        copies: number of equal chains side by side, which share all blocks; a mirrored pair of
            chains does not move sideways.
        task: jump, throw or strike.
        ball_mass: of the ball of a throw [kg], > 0.
        block_mass: of the rod, and of each block that is neither body nor foot [kg], > 0.
        damping: of the travel of each cell, of all copies together [N s/m], >= 0.
        tilt: of the chain from the vertical, forward [rad], 0 to below π/2.
        foot_length: of the sole along the way [m], > 0.
        height: of the body's centre of mass over the sole along the chain, all cells at 0 [m], > 0.
        body_size: side of the cube that has the body's moment of inertia [m], > 0.
        friction: Coulomb's coefficient between foot and floor, >= 0.
        gravity: [m/s²], >= 0.
        springs: mass, permitted stretch and loss.
        actuator: force, speed and stiffness.
        title: name in reports.

    Raises:
        ValueError: a value out of range, a chain of one cell, with an element or a soft actuator.

    Source: ours, after the outlook of Kamp et al. 2024.
    """

    chain: Chain
    body_mass: float
    foot_mass: float
    foot_after: int = 1
    copies: int = 1
    task: Task = Task.JUMP
    ball_mass: float = 0.010
    block_mass: float = 0.005
    damping: float = 0.5
    tilt: float = 0.0
    foot_length: float = 0.160
    height: float = 0.060
    body_size: float = 0.060
    friction: float = 0.8
    gravity: float = 9.81
    springs: Springs = Springs()
    actuator: Actuator = Actuator()
    title: str = ""

    def __post_init__(self):
        check.fields(self, check.positive, body_mass="kg", foot_mass="kg", ball_mass="kg")
        check.fields(self, check.positive, block_mass="kg")
        check.fields(self, check.positive, foot_length="m", height="m", body_size="m")
        check.fields(self, check.not_negative, damping="N s/m", friction="1", gravity="m/s²")
        check.fields(self, check.not_negative, tilt="rad")
        check.fields(self, check.one_of, task=Task)
        check.fields(self, check.whole, foot_after=1, copies=1)
        if self.tilt >= math.pi / 2:
            raise InputError(f"tilt = {math.degrees(self.tilt):.6g} deg: must be below 90 deg.")
        _ = self.chain.levers  # An element has no band whose stretch can be checked.
        if self.chain.actuator_stiffness != math.inf:
            raise InputError(
                "chain.actuator_stiffness: must be infinite; set the stiffness of the hopper's "
                "actuator."
            )
        if not self.foot_after < len(self.chain):
            raise InputError(
                f"foot_after = {self.foot_after}: must be below {len(self.chain)}, the number of "
                f"cells: a cell behind the foot has to push it."
            )
        if not self.frame_mass > 0.0:
            blocks = to_unit(self.body_mass - self.frame_mass, "g")
            raise InputError(
                f"body_mass = {to_unit(self.body_mass, 'g'):.6g} g: must be > {blocks:.6g} g, the "
                f"rod and the other blocks in it (block_mass)."
            )

    @property
    def frame_mass(self) -> float:
        """Mass of the body without rod and other blocks [kg]."""
        return self.body_mass - self.block_mass * (len(self.chain) - 1)

    @property
    def mass(self) -> float:
        """Mass of body and foot [kg]."""
        return self.body_mass + self.foot_mass

    @property
    def moved(self) -> float:
        """Mass that the snap accelerates [kg]: the body, the foot with the ball, or the foot."""
        if self.task is Task.JUMP:
            return self.body_mass
        return self.foot_mass + self.ball_mass * (self.task is Task.THROW)

    @property
    def flying(self) -> float:
        """Mass that flies or strikes [kg]: body and foot, the ball, or the foot."""
        masses = {Task.JUMP: self.mass, Task.THROW: self.ball_mass, Task.STRIKE: self.foot_mass}
        return masses[self.task]

    @property
    def useful(self) -> float:
        """Fraction of the kinetic energy at the stop [1] that flies or strikes."""
        if self.task is Task.JUMP:
            return self.body_mass / self.mass
        return self.ball_mass / self.moved if self.task is Task.THROW else 1.0

    @property
    def load(self) -> float:
        """Weight along the chain that the snap lifts [N]."""
        return self.moved * self.gravity * math.cos(self.tilt)

    @property
    def whole(self) -> Chain:
        """The chain with the forces of all copies together."""
        if self.copies == 1:
            return self.chain
        return replace(self.chain, cells=tuple(_times(c, self.copies) for c in self.chain.levers))

    @property
    def loaded(self) -> Chain:
        """The whole chain with the load on every cell before the foot."""
        return loaded(self.whole, self.foot_after, self.load)

    def __repr__(self):
        title = f"{self.title!r}, " if self.title else ""
        return (
            f"Hopper({title}{self.task}, {len(self.chain)} cells, body "
            f"{to_unit(self.body_mass, 'g'):.4g} g, foot {to_unit(self.foot_mass, 'g'):.4g} g)"
        )


def loaded(chain: Chain, foot_after: int, load: float) -> Chain:
    """The chain with a constant load [N] against the travel of each of its first cells."""
    cells = [
        replace(cell, load=_with(cell.load, load)) if i < foot_after and load else cell
        for i, cell in enumerate(chain.levers)
    ]
    return replace(chain, cells=tuple(cells))


def _with(load: Load | None, force: float) -> Load:
    own = Load.constant(0.0) if load is None else load
    return replace(own, force=tuple(one + force for one in own.force))


def _times(cell: Cell, copies: int) -> Cell:
    """A cell with the forces of several."""
    bands = [replace(band, stiffness=copies * band.stiffness) for band in cell.bands]
    load = cell.load and replace(cell.load, force=tuple(copies * one for one in cell.load.force))
    return replace(cell, band=bands, load=load, friction=copies * cell.friction)
