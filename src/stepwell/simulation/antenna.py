"""An antenna in the simulation: a hinged rod that slides an anchor."""

import math
from typing import Any

from stepwell.base import InputError
from stepwell.robot import Antenna, Robot
from stepwell.simulation import parts
from stepwell.simulation.leg import in_body, places
from stepwell.simulation.simulator import Settings

ROD = 0.0015  # radius [m]
LAYER = 0.006  # distance between the planes of two antennas, so that they can cross [m]
ANCHOR = 0.002  # mass of the part that slides [kg]
SLIDING = 0.2  # its damping [N s/m]
LOOSE = 2e-3  # spring that holds a disconnected rod at rest [N m/rad]


def add_anchor(robot: Robot, antenna: Antenna, body: Any, settings: Settings) -> Any:
    """Add the sliding part with the anchor that an antenna displaces, and return its body."""
    leg = robot.leg(antenna.leg)
    cell = leg.cell_index(antenna.cell)
    if cell != 0:
        raise InputError(
            f"antenna {antenna.name!r} moves an anchor of {leg.chain.names[cell]}: the simulation "
            f"supports antennas of the innermost cell only, whose anchor p is on the body; set "
            f"cell = {leg.chain.names[0]!r}."
        )
    where = places(robot, leg)
    p = in_body(leg, leg.chain.levers[0].bands[0].p)
    travel = math.hypot(*antenna.moves)
    x, y, _ = in_body(leg, antenna.moves)
    axis = (x / travel, y / travel, 0.0)
    name, place = f"{antenna.name}.anchor", (where.joints[0] + p[0], leg.at[1] + p[1], parts.TOP)
    part = body.add_body(name=name, pos=place)
    stops = {"limited": True, "range": (0.0, travel if antenna.connected else 1e-6)}
    parts.slider(part, name, axis, damping=SLIDING, solref_limit=parts.soft(settings), **stops)
    parts.ball(part, ROD, mass=ANCHOR, rgba=parts.ANTENNA, **parts.SEEN)
    return part


def add_rod(spec: Any, robot: Robot, antenna: Antenna, body: Any, settings: Settings) -> None:
    """Add the rod and its hinge, and the coupling to the anchor."""
    name, side = antenna.name, antenna.side
    # The height of its plane over the pivots of the legs [m].
    height = LAYER * (robot.antennas.index(antenna) - (len(robot.antennas) - 1) / 2)
    holder = body.add_body(name=f"{name}.antenna", pos=(*antenna.pivot, height))
    soft, loose = parts.soft(settings, 2), (0.0 if antenna.connected else LOOSE, 0.0, 0.0)
    stops = {"limited": True, "range": (0.0, antenna.swing), "solref_limit": soft}
    gives = {"damping": antenna.damping, "stiffness": loose}
    parts.hinge(holder, f"{name}.antenna", (0.0, 0.0, side), **stops, **gives)
    meets = {"priority": 3, "condim": 3, "friction": (antenna.friction, 0.0, 0.0), "solref": soft}
    touch = {"rgba": parts.ANTENNA, **meets, **parts.ANTENNAS}
    whole, angle = antenna.length + antenna.hook, abs(antenna.angle)
    begin = (0.0, 0.0, 0.0)
    for length, bent in ((antenna.length, 0.0), (antenna.hook, antenna.hook_angle)):
        if length > 0:
            along, across = math.cos(angle + bent), side * math.sin(angle + bent)
            end = (begin[0] + length * along, begin[1] + length * across, 0.0)
            parts.rod(holder, begin, end, ROD, mass=antenna.mass * length / whole, **touch)
            begin = end
    reach = whole + 0.005
    shape = {"size": (reach, reach, 0.02), "type": parts.mujoco.mjtGeom.mjGEOM_BOX}
    holder.add_site(name=f"{name}.feeler", rgba=parts.HIDDEN, **shape)
    # An arm of the body carries the hinge.
    start = (robot.body.length / 2, 0.5 * antenna.pivot[1], 0.012)
    end = (*antenna.pivot, height + 0.004)
    parts.rod(body, start, end, 0.002, mass=0.0, rgba=parts.BODY, **parts.SEEN)
    if antenna.connected:
        joints = {f"{name}.anchor": 1.0, f"{name}.antenna": -antenna.gear}
        parts.combined(spec, f"{name}.lever", joints)
        parts.fixed_length(spec, f"{name}.lever", settings)
