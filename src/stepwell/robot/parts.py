"""Parts of a robot as values: body, legs, antennas and the shared actuator."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Vec2, check, require, to_unit
from stepwell.mechanism import Chain


@dataclass(frozen=True, slots=True, eq=False)
class Antenna(ByValue):
    """A rod on a vertical hinge, with contact-triggered displacement of the anchor p of one cell.

    Without contact the rod rests at `angle`, held by the pull of the band on the anchor. A contact
    turns it back by up to `swing` and moves the anchor in proportion by up to `moves`. A
    `ValueError` refuses values out of range.

    Args:
        name: used in messages and figures.
        pivot: (x, y) of the hinge [m] from the body's origin.
        length, mass: of the rod [m], [kg], > 0.
        angle: from straight ahead at rest [rad], 0 to π; negative for a tip on the right.
        leg, cell: the leg and the cell (index, 0 for the innermost, or name) whose anchor it moves.
        moves: displacement of that anchor p at full swing [m], in the cell's frame.
        swing: largest rotation [rad], > 0, towards the back.
        hook, hook_angle: length of the bent tip [m], >= 0, and its angle from the rod [rad].
        damping: of the hinge [N m s/rad], > 0.
        friction: Coulomb's coefficient between rod and walls, >= 0.
        connected: False disconnects the rod from the anchor; a weak spring then holds the rod at
            rest. The control experiment.

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
                f"moves = (0, 0) of antenna {self.name!r}: must not be zero; to disconnect the "
                f"antenna, set connected = False."
            )

    @property
    def side(self) -> int:
        """+1 for an antenna whose tip points to the left, -1 to the right."""
        return 1 if self.angle > 0 else -1

    @property
    def gear(self) -> float:
        """Displacement of the anchor per rotation [m/rad]."""
        return math.hypot(*self.moves) / self.swing


@dataclass(frozen=True, slots=True, eq=False)
class Body(ByValue):
    """A rigid body on a passive support, the T-foot.

    The origin lies at the height of the legs' pivots; x points forward, y to the left. A
    `ValueError` refuses values out of range, and fewer than three supports.

    Args:
        mass: without blocks, feet and antennas [kg], > 0.
        centre: (x, y, z) of its centre of mass [m].
        supports: (n, 2) points of the T-foot that touch the floor [m], n >= 3.
        length, width: outline in contact with walls [m], > 0, centred at the origin.
        wall_friction: Coulomb's coefficient between walls and body or blocks, >= 0.

    Source: Kamp et al. 2024, Fig. 3, for the T-foot; the numbers are assumed.
    """

    mass: float = 0.260
    centre: tuple[float, float, float] = (0.024, 0.0, 0.0)
    supports: Sequence[Vec2] = ((-0.055, 0.0), (0.038, 0.045), (0.038, -0.045))
    length: float = 0.100
    width: float = 0.070
    wall_friction: float = 0.2

    def __post_init__(self):
        check.fields(self, check.positive, mass="kg", length="m", width="m")
        check.fields(self, check.not_negative, wall_friction="1")
        x, y, z = self.centre
        centre = tuple(check.finite("centre", value, "m") for value in (x, y, z))
        object.__setattr__(self, "centre", centre)
        supports = tuple(check.vector("supports", point) for point in self.supports)
        object.__setattr__(self, "supports", supports)
        require("supports", len(supports), "the body has")
        if len(supports) < 3:
            raise InputError(
                f"supports has {len(supports)} points: must have 3 or more, or the body falls over "
                f"when the feet lift; add a support."
            )


class Profile(StrEnum):
    """Shape of the command over time, from 0 to the amplitude and back."""

    TRIANGLE = "triangle"
    SINE = "sine"
    TRAPEZOID = "trapezoid"


# A trapezoid rests at each end for this fraction of the period.
REST = 0.125


@dataclass(frozen=True, slots=True, eq=False)
class Drive(ByValue):
    """The position command that all legs share; a `ValueError` refuses values out of range.

    Args:
        amplitude: largest stroke [m], > 0.
        period: of one cycle, loading and unloading [s], > 0.
        profile: constant speed (triangle), a sine, or a constant speed with a rest of an eighth of
            the period at both ends (trapezoid).
        stiffness: of the actuator that follows the command [N/m], > 0.
        speed: largest speed of the actuator under load [m/s], > 0; a command that is faster is
            refused, with the shortest period. Infinite by default.

    Source: Kamp et al. 2024, for 0 to 40 to 0 mm; period and stiffness are assumed.
    """

    amplitude: float = 0.040
    period: float = 2.0
    profile: Profile = Profile.TRIANGLE
    stiffness: float = 2000.0
    speed: float = math.inf

    def __post_init__(self):
        check.fields(self, check.positive, amplitude="m", period="s", stiffness="N/m")
        check.fields(self, check.one_of, profile=Profile)
        if self.speed != math.inf:
            check.fields(self, check.positive, speed="m/s")
        if self.least_period > self.period * (1.0 + 1e-9):
            raise InputError(
                f"period = {self.period:.6g} s: must be >= {self.least_period:.4g} s, because the "
                f"actuator moves at {to_unit(self.speed, 'mm/s'):.4g} mm/s at most; use a longer "
                f"period, a shorter stroke or a faster actuator."
            )

    @property
    def least_period(self) -> float:
        """Shortest period [s] of this command that the actuator can follow; 0 without a limit."""
        # Speed over the mean speed, at the fastest point of the command.
        fastest = {Profile.SINE: math.pi / 2.0, Profile.TRAPEZOID: 1.0 / (1.0 - 2.0 * REST)}
        return 2.0 * self.amplitude * fastest.get(self.profile, 1.0) / self.speed

    def stroke(self, time: ArrayLike) -> Floats:
        """The commanded stroke [m] at times [s] of any shape, 0 .. `amplitude`; 0 before time 0."""
        time = np.asarray(time, float)
        phase = np.where(time > 0, time / self.period % 1.0, 0.0)
        out = 1.0 - np.abs(2.0 * phase - 1.0)
        if self.profile is Profile.SINE:
            out = (1.0 - np.cos(2.0 * np.pi * phase)) / 2.0
        elif self.profile is Profile.TRAPEZOID:
            out = np.clip((out - REST) / (1.0 - 2.0 * REST), 0.0, 1.0)
        return self.amplitude * out


@dataclass(frozen=True, slots=True, eq=False)
class Blocks(ByValue):
    """Mass, damping and size of the blocks of every leg; a `ValueError` refuses other values.

    Args:
        mass: of each block that moves [kg], > 0, its slider included.
        carriage: of the actuator's moving part, which joins the outermost blocks [kg], > 0.
        damping: of each cell's travel [N s/m], > 0, for losses in rubber and joints.
        width, length: outline in contact with walls and other legs [m], > 0.
        outer: mass of the outermost block [kg], > 0, which the carriage guides; `mass` by default.
        rail_friction: Coulomb friction of the rail on the slider of every other block [N], >= 0.
            In a leg of two cells it acts on the inner cell alone.
    """

    mass: float = 0.006
    carriage: float = 0.010
    damping: float = 1.0
    width: float = 0.030
    length: float = 0.020
    outer: float | None = None
    rail_friction: float = 0.0

    def __post_init__(self):
        check.fields(self, check.positive, mass="kg", carriage="kg", damping="N s/m")
        check.fields(self, check.positive, width="m", length="m")
        check.fields(self, check.not_negative, rail_friction="N")
        if self.outer is not None:
            check.fields(self, check.positive, outer="kg")

    def masses(self, count: int) -> tuple[float, ...]:
        """(count,) mass of each block that moves in a leg of `count` cells [kg], inner first."""
        return (*[self.mass] * (count - 1), self.mass if self.outer is None else self.outer)

    def rails(self, count: int) -> tuple[float, ...]:
        """(count,) rail friction on the travel of each cell of a leg [N], inner first.

        A cell that moves takes along every slider outwards of it.
        """
        return tuple(self.rail_friction * (count - 1 - i) for i in range(count))


@dataclass(frozen=True, slots=True, eq=False)
class Foot(ByValue):
    """A foot at the tip of a V of two equal links.

    The V hangs from the outermost block and the one before it. When the outermost cell opens by a
    travel s, its pivots are `span` + s apart and the foot rises. A `ValueError` refuses values out
    of range, and pivots further apart than two links reach.

    Args:
        link: length of each link [m], > 0.
        span: distance of the two pivots with the outermost cell at 0 [m], > 0.
        mass: of the foot [kg], > 0.
        below: preload depth: feet below the plane of the supports, all cells at 0 [m], >= 0.
        radius: of the ball in contact with the floor [m], > 0.

    Source: Kamp et al. 2024, Fig. 3, for the idea, their notes for `link`, `span` and `mass`;
    `below` and `radius` are ours.
    """

    link: float = 0.035
    span: float = 0.040
    mass: float = 0.0066
    below: float = 0.0009
    radius: float = 0.004

    def __post_init__(self):
        check.fields(self, check.positive, link="m", span="m", mass="kg", radius="m")
        check.fields(self, check.finite, below="m")
        if self.below < 0:
            raise InputError(
                f"below = {to_unit(self.below, 'mm'):.6g} mm: must be >= 0, or the feet never "
                f"touch the floor."
            )
        if self.span >= 2 * self.link:
            raise InputError(
                f"span = {to_unit(self.span, 'mm'):.6g} mm: must be < "
                f"{to_unit(2.0 * self.link, 'mm'):.6g} mm, the two links stretched out; use longer "
                "links."
            )

    def depth(self, travel: ArrayLike) -> Floats:
        """Depth of the tip below the pivots [m] at travels [m] of the outermost cell, of any shape.

        √(link² - (span + travel)²/4), for travels 0 .. 2 `link` - `span`.
        """
        width = self.span + np.asarray(travel, float)
        return np.sqrt(np.maximum(self.link**2 - width**2 / 4.0, 0.0))

    def lever(self, travel: ArrayLike) -> Floats:
        """Opening force on the outermost cell over ground reaction force [1], at travels [m].

        By virtual work -d(depth)/d(travel) = (span + travel) / (4 depth).
        """
        width = self.span + np.asarray(travel, float)
        return width / (4.0 * self.depth(travel))

    @property
    def contact_travel(self) -> float:
        """Travel of the outermost cell [m] beyond which the foot has no contact."""
        depth = float(self.depth(0.0)) - self.below
        if depth <= 0.0:
            return 2 * self.link - self.span
        return 2.0 * math.sqrt(self.link**2 - depth**2) - self.span


@dataclass(frozen=True, slots=True, eq=False)
class Leg(ByValue):
    """A chain that carries a foot.

    The innermost block is part of the body and the chain extends backwards. A cell that opens
    during stance drives the body forward. The last cell lifts the foot, the cells before it make
    the step. A `ValueError` refuses a chain of one cell, or one with a finite actuator stiffness.

    Args:
        name: used in messages and figures.
        chain: two cells or more, inner first, driven by a prescribed stroke.
        at: (x, y) of the foot [m] from the body's origin with every cell at 0; x forward, y left.
            Anchors' first coordinate points away from the midline.
    """

    name: str
    chain: Chain
    at: Vec2

    def __post_init__(self):
        check.fields(self, check.vector, at="m")
        if len(self.chain) < 2:
            raise InputError(
                f"leg {self.name!r} has {len(self.chain)} cell: must have 2 or more; the last "
                f"one lifts the foot and those before it make the step."
            )
        if self.chain.elements:
            raise InputError(
                f"leg {self.name!r} has elements: must have cells of levers and bands alone, whose "
                f"blocks carry the foot."
            )
        if self.chain.actuator_stiffness != float("inf"):
            raise InputError(
                f"leg {self.name!r}: actuator_stiffness = {self.chain.actuator_stiffness:g} N/m: "
                f"must be infinite; set the stiffness of the actuator in the robot's drive."
            )

    @property
    def side(self) -> int:
        """+1 for a leg on or left of the midline, -1 for one right of it."""
        return 1 if self.at[1] >= 0 else -1

    @property
    def stroke(self) -> float:
        """Σ S_i over the cells that make the step [m]: u_max, the largest advance per cycle."""
        return self.chain.full_stroke - self.chain.cells[-1].full_travel

    def with_anchors(self, cell: int | str, p: Vec2 | None = None, q: Vec2 | None = None) -> "Leg":
        """The same leg with the anchors p, q [m] of one cell moved; None keeps an anchor.

        The cell is given as for `cell_index`; a `ValueError` refuses impossible anchors.
        """
        cells, index = list(self.chain.levers), self.cell_index(cell)
        cells[index] = cells[index].with_anchors(p, q)
        return replace(self, chain=replace(self.chain, cells=tuple(cells)))

    def with_moved_anchor(self, cell: int | str, moves: Vec2, share: float = 1.0) -> "Leg":
        """The same leg with the anchor p of one cell moved by `share` [1] of `moves` [m]."""
        p = self.chain.levers[self.cell_index(cell)].bands[0].p
        return self.with_anchors(cell, p=(p[0] + share * moves[0], p[1] + share * moves[1]))

    def cell_index(self, cell: int | str) -> int:
        """The index of a cell, 0 the innermost, by that index or its name; or a `ValueError`."""
        names = self.chain.names
        if isinstance(cell, str) and cell in names:
            return names.index(cell)
        if isinstance(cell, int) and 0 <= cell < len(names):
            return cell
        given = f"{cell + 1} (index {cell} in Python)" if isinstance(cell, int) else repr(cell)
        raise InputError(
            f"leg {self.name!r} has no cell {given}: must be one of {', '.join(map(repr, names))}, "
            f"or a number up to {len(names)} (index {len(names) - 1} in Python)."
        )
