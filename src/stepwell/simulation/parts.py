"""Parts of a robot's model: visible shapes, colliding shapes, rods, bands."""

from collections.abc import Sequence
from typing import Any

from stepwell.base import InputError
from stepwell.mechanism import Band, Cubic, Linear
from stepwell.robot import Robot
from stepwell.simulation.simulator import Settings, mujoco

Vec3 = tuple[float, float, float]
Colour = tuple[float, float, float, float]
Place = tuple[Any, Vec3]  # a body, and a point of it [m]

TOP = 0.007  # levers and bands lie on top of the blocks, where they are visible [m]

# The colours of the figures, which a test compares: red, green, blue, opacity.
BODY = (0.45, 0.47, 0.50, 0.55)
BLOCK = (0.66, 0.66, 0.66, 1.0)
LEVER = (0.13, 0.13, 0.13, 1.0)
LINK = FOOT = (0.00, 0.45, 0.70, 1.0)
SUPPORT = (0.84, 0.37, 0.00, 1.0)
ANTENNA = (0.90, 0.62, 0.00, 1.0)
# Colours of the bands of each cell, inner first; after six they repeat.
BANDS: tuple[Colour, ...] = (
    (0.00, 0.62, 0.45, 1.0),
    (0.80, 0.47, 0.65, 1.0),
    (0.90, 0.62, 0.00, 1.0),
    (0.34, 0.71, 0.91, 1.0),
    (0.48, 0.42, 0.00, 1.0),
    (0.00, 0.00, 0.00, 1.0),
)
WALL = (0.35, 0.38, 0.45, 1.0)
HIDDEN = (0.0, 0.0, 0.0, 0.0)

STEP = (0.80, 0.70, 0.55, 1.0)
GROOVE = (0.45, 0.45, 0.47, 1.0)
OTHER_FRICTION = (0.72, 0.82, 0.90, 1.0)
PLATE = (0.62, 0.74, 0.58, 1.0)

# Collision groups. The floor collides with supports, feet and loose plates, walls with all other
# parts of the robot, antennas with each other and with moving parts of a leg, not with body or
# carriage. A patch of the floor has a block for the feet and one for the supports.
FLOOR: dict[str, Any] = {"contype": 1, "conaffinity": 1 | 64}
STANDS: dict[str, Any] = {"contype": 1 | 32, "conaffinity": 1}
FEET: dict[str, Any] = {"contype": 1 | 8 | 16, "conaffinity": 1}
UNDER_FEET: dict[str, Any] = {"contype": 0, "conaffinity": 16 | 64}
UNDER_SUPPORTS: dict[str, Any] = {"contype": 0, "conaffinity": 32}
UNDER_ROBOT: dict[str, Any] = {"contype": 0, "conaffinity": 16 | 32}
PLATES: dict[str, Any] = {"contype": 64, "conaffinity": 64}
OUTLINE: dict[str, Any] = {"contype": 2, "conaffinity": 4}
BLOCKS: dict[str, Any] = {"contype": 2 | 8, "conaffinity": 4}
ANTENNAS: dict[str, Any] = {"contype": 2 | 8, "conaffinity": 4 | 8}
OBSTACLE: dict[str, Any] = {"contype": 4, "conaffinity": 2}
SEEN: dict[str, Any] = {"contype": 0, "conaffinity": 0}

# A contact carries nothing at first, and its full force at a penetration of 0.03 mm. With MuJoCo's
# own values it carries nine tenths from the first on: a foot at rest detaches and returns at every
# step, and its ground reaction force does not converge. A softer contact converges faster, but the
# foot then penetrates so far that gaits change at another anchor.
TOUCHING = (0.0, 0.95, 3e-5, 0.5, 2.0)

# Rods stretch by hundredths of a millimetre under a leg's forces.
STIFF = (0.98, 0.99, 0.001, 0.5, 2.0)


def box(body: Any, size: Vec3, at: Vec3 = (0, 0, 0), **more: Any) -> Any:
    """A box of this full size [m] about a point of the body."""
    half = [length / 2 for length in size]
    return body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half, pos=at, **more)


def ball(body: Any, radius: float, at: Vec3 = (0, 0, 0), **more: Any) -> Any:
    """A ball about a point of the body."""
    return body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(radius, 0, 0), pos=at, **more)


def rod(body: Any, start: Vec3, end: Vec3, radius: float, **more: Any) -> Any:
    """A rod with round ends between two points of the body."""
    return body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=(*start, *end), size=(radius, 0, 0), **more
    )


def hull(robot: Robot, body: Any, size: Vec3, at: Vec3 = (0, 0, 0), **more: Any) -> None:
    """A box of the body or of a block, which collides with walls."""
    friction = (robot.body.wall_friction, 0.0, 0.0)
    box(body, size, at, priority=2, condim=3, friction=friction, **more)


def stand(
    body: Any, names: tuple[str, str], radius: float, at: Vec3, settings: Settings, **more: Any
) -> None:
    """A ball that collides with the floor, and a touch sensor around it; `names` of both."""
    touch = {"priority": 1, "condim": 3, "solref": soft(settings), "solimp": TOUCHING}
    ball(body, radius, at, name=names[0], **touch, **more)
    body.add_site(name=names[1], pos=at, size=(1.1 * radius,) * 3, rgba=HIDDEN)


def soft(settings: Settings, times: float = 1.0) -> tuple[float, float]:
    """Time constant and damping ratio of a contact or a stop, as MuJoCo's solref."""
    return times * settings.contact_time, 1.0


def slider(body: Any, name: str, axis: Vec3, **more: Any) -> Any:
    """A sliding joint."""
    return body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, **more)


def hinge(body: Any, name: str, axis: Vec3, **more: Any) -> Any:
    """A hinge."""
    return body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis, **more)


def site(body: Any, name: str, at: Vec3 = (0, 0, 0)) -> None:
    """A named point of the body."""
    body.add_site(name=name, pos=at, size=(0.001, 0.001, 0.001), rgba=HIDDEN)


def between(spec: Any, name: str, sites: Sequence[str], **more: Any) -> Any:
    """A straight line between two named points."""
    tendon = spec.add_tendon(name=name, **more)
    for point in sites:
        tendon.wrap_site(point)
    return tendon


def combined(spec: Any, name: str, joints: dict[str, float], **more: Any) -> Any:
    """A length that is a sum of joint positions with these factors."""
    tendon = spec.add_tendon(name=name, **more)
    for joint, factor in joints.items():
        tendon.wrap_joint(joint, factor)
    return tendon


def fixed_length(spec: Any, tendon: str, settings: Settings) -> None:
    """Keep a line or a sum at its length in the model's reference position."""
    equality = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_TENDON,
        objtype=mujoco.mjtObj.mjOBJ_TENDON,
        name=tendon,
        name1=tendon,
        solref=soft(settings),
        solimp=STIFF,
    )
    equality.data[0] = 0.0


def stretch(band: Band) -> dict[str, Any]:
    """Stiffness and rest length of the line between the anchors of a band."""
    law = band.law
    if not isinstance(law, Linear | Cubic):
        raise InputError(
            f"law = {type(law).__name__}: the simulation supports linear and cubic bands; fit a "
            "cubic law (quadratic_per_mm, cubic_per_mm2)."
        )
    a2, a3 = (law.a2, law.a3) if isinstance(law, Cubic) else (0.0, 0.0)
    stiffness = (band.stiffness, band.stiffness * a2, band.stiffness * a3)
    least = band.rest_length if band.two_sided else 0.0
    return {"stiffness": stiffness, "springlength": (least, band.rest_length)}
