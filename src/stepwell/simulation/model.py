"""MuJoCo model of a robot, and its sensors."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from stepwell.base import Floats, InputError, Ints
from stepwell.robot import Antenna, Arena, Robot
from stepwell.simulation import parts
from stepwell.simulation.arenas.surroundings import add_arena, obstacle_names, start_level
from stepwell.simulation.leg import (
    LegModel,
    add_leg,
    cell_joints,
    hinge_angles,
    in_body,
    places,
    sides,
    swung,
)
from stepwell.simulation.simulator import Linkage, Model, Settings, Spec, mujoco
from stepwell.simulation.solids import add_parts

TYPE = mujoco.mjtSensor
OBJECT = mujoco.mjtObj


def rod_names(robot: Robot) -> Iterator[str]:
    """Names of lines of fixed length; a stretched one is the first sign of an invalid run."""
    for leg in robot.legs:
        yield from (f"{leg.name}.{cell}.lever" for cell in leg.chain.names)
        yield from (f"{leg.name}.link.{end}" for end in ("in", "out"))


def add_sensors(spec: Any, robot: Robot, arena: Arena | None) -> None:
    """Add every sensor that a recording needs."""

    def add(kind: Any, what: Any, target: str, of: str = "") -> None:
        name = f"{target}.{of}" if of else target
        spec.add_sensor(name=name, type=kind, objname=target, objtype=what)

    add(TYPE.mjSENS_FRAMEPOS, OBJECT.mjOBJ_XBODY, "body", "position")
    add(TYPE.mjSENS_FRAMEQUAT, OBJECT.mjOBJ_XBODY, "body", "attitude")
    add(TYPE.mjSENS_JOINTPOS, OBJECT.mjOBJ_JOINT, "stroke")
    add(TYPE.mjSENS_ACTUATORFRC, OBJECT.mjOBJ_ACTUATOR, "drive")
    for leg in robot.legs:
        for cell in leg.chain.names:
            add(TYPE.mjSENS_TENDONPOS, OBJECT.mjOBJ_TENDON, f"{leg.name}.{cell}.travel")
        add(TYPE.mjSENS_FRAMEPOS, OBJECT.mjOBJ_SITE, f"{leg.name}.tip", "position")
        add(TYPE.mjSENS_FRAMELINVEL, OBJECT.mjOBJ_SITE, f"{leg.name}.tip", "velocity")
        add(TYPE.mjSENS_TOUCH, OBJECT.mjOBJ_SITE, f"{leg.name}.sole")
    for i in range(len(robot.body.supports)):
        add(TYPE.mjSENS_TOUCH, OBJECT.mjOBJ_SITE, f"support {i + 1}")
    for antenna in robot.antennas:
        add(TYPE.mjSENS_JOINTPOS, OBJECT.mjOBJ_JOINT, f"{antenna.name}.antenna")
        add(TYPE.mjSENS_TOUCH, OBJECT.mjOBJ_SITE, f"{antenna.name}.feeler")
    for name in obstacle_names(arena) if arena is not None else ():
        add(TYPE.mjSENS_TOUCH, OBJECT.mjOBJ_SITE, name)
    for name in rod_names(robot):
        add(TYPE.mjSENS_TENDONPOS, OBJECT.mjOBJ_TENDON, name, "length")


def columns(model: Model) -> dict[str, slice]:
    """The columns of each sensor among all readings."""
    return {
        model.sensor(i).name: slice(int(start), int(start + size))
        for i, (start, size) in enumerate(zip(model.sensor_adr, model.sensor_dim, strict=True))
    }


def contacts(model: Model) -> Ints:
    """(m,) columns with contact forces."""
    touches = np.flatnonzero(model.sensor_type == int(TYPE.mjSENS_TOUCH))
    return np.asarray(model.sensor_adr[touches], np.int64)


def sampled(readings: Floats, pending: Floats, every: int, columns: Ints) -> tuple[Floats, Floats]:
    """The readings of every `every`-th step, with contact forces as means since the last sample.

    Readings of each step (..., n, sensors) follow those pending since the last sample; `columns`
    are the contact forces. Returns the samples, and the readings that are pending then.
    """
    steps = np.concatenate([pending, readings], axis=-2)
    *some, n, width = steps.shape
    end = n - n % every
    windows = steps[..., :end, :].reshape(*some, n // every, every, width)
    samples = windows[..., -1, :].copy()
    # Overflows are detected later, in the samples.
    with np.errstate(over="ignore", invalid="ignore"):
        samples[..., columns] = windows[..., columns].mean(axis=-2)
    return samples, steps[..., end:, :].copy()


SUPPORT = 0.003  # radius of the balls under the T-foot [m]
HUNG = 0.050  # height of the feet above the floor of a robot without gravity [m]
GUIDE = 1.0  # damping of the actuator's guide [N s/m]


def spec(
    robot: Robot,
    arena: Arena | None = None,
    settings: Settings | None = None,
    *,
    drawn: bool = True,
) -> Spec:
    """The editable model of a robot in an arena, or on a bare floor, and with these settings.

    Without `drawn`, parts of the robot that can be cut have masses and collide, but no meshes to
    look at, which would slow down a run; joints and states are the same.

    Returns:
        MuJoCo's MjSpec, in SI. Its reference position has every lever at θ = 0; the keyframe
        "start" has the feet at the floor and every cell at 0.

    Raises:
        ValueError: a band, load or antenna that the simulator does not support.
    """
    settings = settings or Settings()
    for leg in robot.legs:
        for name, cell in zip(leg.chain.names, leg.chain.levers, strict=True):
            if cell.load is not None:
                raise InputError(
                    f"leg {leg.name!r}, cell {name!r} has a load: in the simulation weight "
                    f"and floor load the robot; remove the load."
                )
    model = mujoco.MjSpec()
    model.modelname = robot.title or "robot"
    model.compiler.degree = False
    _options(model, robot, settings)
    scenery(model)
    body = _body(model, robot, settings)
    _light(body)
    carriage = _carriage(model, robot, body)
    anchors: dict[str, dict[int, Any]] = {leg.name: {} for leg in robot.legs}
    for antenna in robot.antennas:
        cell = robot.leg(antenna.leg).cell_index(antenna.cell)
        anchors[antenna.leg][cell] = add_anchor(robot, antenna, body, settings)
        add_rod(model, robot, antenna, body, settings)
    for leg in robot.legs:
        add_leg(LegModel(model, body, carriage, robot, leg, anchors[leg.name], settings))
    if arena is not None:
        add_arena(model, arena, robot, settings)
    add_sensors(model, robot, arena)
    compiled = model.compile()
    start = _start_position(compiled, robot, arena, settings)
    add_parts(model, robot, (compiled, start), settings, drawn)
    model.add_key(name="start", qpos=start)
    return model


def _options(model: Any, robot: Robot, settings: Settings) -> None:
    option = model.option
    option.timestep = settings.time_step
    option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{settings.integrator.upper()}")
    option.gravity = (0.0, 0.0, -robot.floor.gravity)
    # The pyramidal cone lets feet creep, which changes the gait.
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    # A sticking foot creeps, less for a larger value: 7 µm a second at 97 % of its friction limit.
    option.impratio = 100.0


def scenery(model: Any) -> None:
    """Add the floor, named "floor", the sky, and the look of a picture."""
    model.visual.headlight.ambient = (0.48, 0.48, 0.49)
    model.visual.headlight.diffuse = (0.20, 0.20, 0.20)
    model.visual.headlight.specular = (0.0, 0.0, 0.0)
    model.visual.quality.shadowsize, model.visual.quality.offsamples = 4096, 4
    model.visual.global_.offwidth, model.visual.global_.offheight = 1920, 1080
    # Specks at the edge of the shadows are far from the robot.
    model.visual.map.shadowclip = 2.5
    model.visual.map.znear, model.visual.map.zfar = 0.05, 200.0
    model.visual.rgba.haze = (0.97, 0.98, 0.99, 1.0)
    model.stat.extent = 0.3
    sky = {"rgb1": (0.97, 0.98, 0.99), "rgb2": (0.80, 0.85, 0.90), "width": 256, "height": 1536}
    kinds = mujoco.mjtTexture
    gradient = {"type": kinds.mjTEXTURE_SKYBOX, "builtin": mujoco.mjtBuiltin.mjBUILTIN_GRADIENT}
    model.add_texture(name="sky", **gradient, **sky)
    model.add_texture(
        name="floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=256,
        height=256,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=(0.93, 0.93, 0.92),
        rgb2=(0.88, 0.89, 0.89),
    )
    role = mujoco.mjtTextureRole
    layers = ["floor" if i == role.mjTEXROLE_RGB else "" for i in range(role.mjNTEXROLE)]
    # One square of the floor is 100 mm wide.
    model.add_material(
        name="floor", textures=layers, texrepeat=(5, 5), texuniform=True, specular=0.0
    )
    floor = {"type": mujoco.mjtGeom.mjGEOM_PLANE, "size": (0, 0, 0.05), "material": "floor"}
    model.worldbody.add_geom(name="floor", **floor, **parts.FLOOR)


def _light(body: Any) -> None:
    """Add a lamp that stays over the robot, so that its parts cast shadows wherever it walks."""
    far, towards = 0.6, np.array([0.32, -0.38, -1.0])
    body.add_light(
        name="lamp",
        pos=-far * towards / np.linalg.norm(towards),
        dir=towards,
        mode=mujoco.mjtCamLight.mjCAMLIGHT_TRACKCOM,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        diffuse=(0.55, 0.55, 0.54),
        specular=(0.2, 0.2, 0.2),
        castshadow=True,
    )


def _body(model: Any, robot: Robot, settings: Settings) -> Any:
    body = model.worldbody.add_body(name="body", pos=(0.0, 0.0, robot.pivot_height))
    body.add_freejoint(name="body")
    # A plate of the outline's size; its mass is at the body's centre of mass.
    size = (robot.body.length, robot.body.width, 0.020)
    weight = {"mass": robot.body.mass, "rgba": parts.HIDDEN, "group": 4, **parts.SEEN}
    parts.box(body, size, robot.body.centre, **weight)
    outline = {"mass": 0.0, "rgba": parts.BODY, **parts.OUTLINE}
    parts.hull(robot, body, size, (0.0, 0.0, 0.012), **outline)
    seen = {"mass": 0.0, "rgba": parts.SUPPORT}
    touch = {"friction": (robot.support_friction, 0.0, 0.0), **seen, **parts.STANDS}
    for i, (x, y) in enumerate(robot.body.supports):
        name, foot = f"support {i + 1}", (x, y, SUPPORT - robot.pivot_height)
        parts.stand(body, (name, name), SUPPORT, foot, settings, **touch)
        parts.rod(body, foot, (0.4 * x, 0.4 * y, 0.0), 0.002, **seen, **parts.SEEN)
    for leg in robot.legs:
        # The innermost block is part of the body.
        inner = (leg.at[0] + robot.foot.span / 2 + robot.blocks.length, leg.at[1], 0.0)
        size = (robot.blocks.length / 2, robot.blocks.width, 0.008)
        parts.hull(robot, body, size, inner, **outline)
    body.add_camera(name="above", pos=(0.0, 0.0, 0.9), mode=mujoco.mjtCamLight.mjCAMLIGHT_TRACKCOM)
    return body


def _carriage(model: Any, robot: Robot, body: Any) -> Any:
    full, blocks = robot.legs[0].chain.full_stroke, robot.blocks
    carriage = body.add_body(name="carriage")
    parts.slider(carriage, "stroke", (-1.0, 0.0, 0.0), ref=full / 2, damping=GUIDE)
    ends = [leg.at[0] - robot.foot.span / 2 - full / 2 for leg in robot.legs]
    across = [leg.at[1] for leg in robot.legs]
    middle = (min(ends), (min(across) + max(across)) / 2, 0.012)
    bar = (0.008, max(max(across) - min(across), 0.008), 0.006)
    parts.box(carriage, bar, middle, mass=blocks.carriage, rgba=parts.BLOCK, **parts.SEEN)
    size = (blocks.length, blocks.width, 0.008)
    outline = {"mass": 0.0, "rgba": parts.BLOCK, **parts.OUTLINE}
    for end, y in zip(ends, across, strict=True):
        parts.hull(robot, carriage, size, (end, y, 0.0), **outline)
    reach = {"trntype": mujoco.mjtTrn.mjTRN_JOINT, "ctrllimited": True, "ctrlrange": (0.0, full)}
    drive = model.add_actuator(name="drive", target="stroke", **reach)
    drive.set_to_position(kp=robot.drive.stiffness, dampratio=1.0)
    return carriage


def _start_position(
    model: Model, robot: Robot, arena: Arena | None, settings: Settings
) -> np.ndarray:
    """Joint positions (nq,) of the robot at the arena's start, with every cell at 0."""
    joints = {"stroke": 0.0}
    for leg in robot.legs:
        for i, name in enumerate(leg.chain.names):
            joints[f"{leg.name}.{name}.side"] = leg.side * swung(robot, leg, i)
        half = [cell.full_travel / 2 for cell in leg.chain.cells]
        # The outermost block slides on the carriage, whose joint is the stroke.
        joints |= {f"{leg.name}.{name}.block": 0.0 for name in leg.chain.names[:-1]}
        joints[f"{leg.name}.foot.x"] = sum(half[:-1]) + half[-1] / 2
        reference = -places(robot, leg).foot[1]
        joints[f"{leg.name}.foot.z"] = reference - float(robot.foot.depth(0.0))
        if settings.linkage is Linkage.HINGES:
            joints |= hinge_angles(robot, leg)
    q = model.qpos0.copy()
    for joint, value in joints.items():
        q[model.joint(joint).qposadr[0]] = value
    heading, x, y = (arena.heading, *arena.start) if arena else (0.0, 0.0, 0.0)
    root = model.joint("body").qposadr[0]
    # Without gravity the robot hangs clear of the floor, or its feet would push it off.
    gap = 1e-5 if robot.floor.gravity > 0 else HUNG
    level = start_level(arena, robot) if arena else 0.0
    q[root : root + 3] = x, y, level + robot.pivot_height + robot.foot.below + gap
    q[root + 3 : root + 7] = np.cos(heading / 2), 0.0, 0.0, np.sin(heading / 2)
    return q


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
    (jx, jy, top), _ = cell_joints(robot, leg, 0)
    side = sides(robot, leg)[0]
    p = in_body(side, leg.chain.levers[0].bands[0].p)
    travel = math.hypot(*antenna.moves)
    x, y, _ = in_body(side, antenna.moves)
    axis = (x / travel, y / travel, 0.0)
    name, place = (f"{antenna.name}.anchor", (jx + p[0], jy + p[1], top))
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
