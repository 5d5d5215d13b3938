"""MuJoCo model of a hopper: a body, blocks that slide along the chain, a foot or a ball."""

import math
from typing import Any

import numpy as np

from stepwell.base import Floats
from stepwell.robot import Hopper, Task
from stepwell.simulation import parts
from stepwell.simulation.model import scenery
from stepwell.simulation.simulator import Spec, mujoco

BALL = 0.008  # radius of a thrown ball [m]
SOLE = 0.003  # radius of the balls at both ends of the sole [m]
WIDE = 0.040  # width of blocks and sole [m]
THICK = 0.004  # half the thickness of a block along the chain [m]
# A stop and a contact carry their full force at a penetration of 0.1 mm.
HARD = (0.9, 0.99, 1e-4, 0.5, 2.0)


def out_of(hopper: Hopper) -> tuple[float, float, float]:
    """Unit vector of the foot's travel: down to the floor for a jump, else up along the tilt."""
    sign = -1.0 if hopper.task is Task.JUMP else 1.0
    return (sign * math.sin(hopper.tilt), 0.0, sign * math.cos(hopper.tilt))


def hopper_spec(hopper: Hopper, time_step: float, contact_time: float) -> Spec:
    """The editable model of a hopper; cells act by applied forces and have no parts.

    Joints: of a jump `x`, `z` and `pitch` of the body; then the displacement of each block from
    the body along the chain, `block 1` the innermost; of a throw the ball's along the chain.
    """
    model = mujoco.MjSpec()
    model.modelname = hopper.title or "hopper"
    model.compiler.degree = False
    option = model.option
    option.timestep, option.gravity = time_step, (0.0, 0.0, -hopper.gravity)
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10.0
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    option.iterations, option.tolerance = 50, 1e-12
    option.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    touch = {"solref": (contact_time, 1.0), "solimp": HARD, "condim": 3}
    touch["friction"] = (hopper.friction, 0.0, 0.0)
    scenery(model)
    _light(model)
    out = np.array(out_of(hopper))
    jumps = hopper.task is Task.JUMP
    at = -hopper.height * out if jumps else np.array((0.0, 0.0, 2.0 * hopper.body_size))
    body = model.worldbody.add_body(name="body", pos=at)
    if jumps:
        parts.slider(body, "x", (1.0, 0.0, 0.0))
        parts.slider(body, "z", (0.0, 0.0, 1.0))
        parts.hinge(body, "pitch", (0.0, 1.0, 0.0))
    side = hopper.body_size
    size = (side, side, side)
    seen = {**parts.SEEN, "rgba": parts.BODY}
    parts.box(body, size, mass=hopper.frame_mass, quat=_turn(hopper), **seen)
    _blocks(model, hopper, body, touch)
    _stops(model, hopper, (contact_time, 1.0))
    _lines(model, hopper, body)
    if hopper.task is Task.THROW:
        _ball(model, hopper, at, touch)
    return model


def _turn(hopper: Hopper) -> tuple[float, float, float, float]:
    return (math.cos(hopper.tilt / 2), 0.0, math.sin(hopper.tilt / 2), 0.0)


def _light(model: Any) -> None:
    """Add a lamp, so that parts cast shadows."""
    light = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    look = {"diffuse": (0.45, 0.45, 0.44), "specular": (0.2, 0.2, 0.2), "castshadow": True}
    model.worldbody.add_light(name="lamp", pos=(0, 0, 3), dir=(0.3, 0.4, -1), type=light, **look)


def place_of(hopper: Hopper, number: int) -> Floats:
    """(3,) place of a block in the frame of the body with all cells at 0 [m]; 0 is the innermost.

    Blocks are drawn one below the other; only their masses and their travel count.
    """
    gap = hopper.body_size / 2 + 2 * THICK
    return np.array(out_of(hopper)) * (gap + number * 4 * THICK)


def _blocks(model: Any, hopper: Hopper, body: Any, touch: dict[str, Any]) -> None:
    out, foot = out_of(hopper), hopper.foot_after - 1
    jumps = hopper.task is Task.JUMP
    for i in range(len(hopper.chain)):
        at = place_of(hopper, i)
        block = body.add_body(name=f"block {i + 1}", pos=at)
        parts.slider(block, f"block {i + 1}", out)
        size, is_foot = (0.5 * WIDE, 0.5 * WIDE, 2 * THICK), i == foot
        mass = hopper.foot_mass if is_foot else hopper.block_mass
        colour = parts.FOOT if is_foot else parts.BLOCK
        groups = parts.FEET if is_foot and hopper.task is Task.THROW else parts.SEEN
        if not (is_foot and jumps):
            more = {**groups, **(touch if is_foot else {})}
            parts.box(block, size, mass=mass, rgba=colour, quat=_turn(hopper), **more)
            continue
        parts.box(block, size, mass=0.0, rgba=colour, quat=_turn(hopper), **parts.SEEN)
        sole = hopper.height * np.array(out) - at
        plate = (hopper.foot_length, WIDE, SOLE)
        middle = sole + np.array((0.0, 0.0, SOLE))
        parts.box(block, plate, tuple(middle), mass=mass, rgba=colour, **parts.SEEN)
        for y in (-0.4 * WIDE, 0.4 * WIDE):
            leg = {"mass": 0.0, "rgba": colour, **parts.SEEN}
            parts.rod(block, (0.0, y, 0.0), (middle[0], y, middle[2]), 0.002, **leg)
        for x in (-hopper.foot_length / 2, hopper.foot_length / 2):
            end = {"mass": 0.0, "rgba": colour, "priority": 1, **parts.STANDS, **touch}
            parts.ball(block, SOLE, (sole[0] + x, 0.0, sole[2] + SOLE), **end)


def _stops(model: Any, hopper: Hopper, soft: tuple[float, float]) -> None:
    """Add the stops and the friction of each cell, on the difference of its blocks' travels."""
    before: dict[str, float] = {}
    for i, cell in enumerate(hopper.whole.levers):
        stops = {"limited": True, "range": (0.0, cell.full_travel), "solref_limit": soft}
        rubs = {"frictionloss": cell.friction, "solref_friction": soft, "solimp_friction": HARD}
        joints = {f"block {i + 1}": 1.0} | before
        parts.combined(model, f"travel {i + 1}", joints, solimp_limit=HARD, **stops, **rubs)
        before = {f"block {i + 1}": -1.0}


def _lines(model: Any, hopper: Hopper, body: Any) -> None:
    """Add two lines for each cell, which carry nothing, to see which blocks it joins."""
    wide, before = 0.2 * WIDE, body
    at = np.array(out_of(hopper)) * hopper.body_size / 2
    for i in range(len(hopper.chain)):
        block, colour = model.body(f"block {i + 1}"), parts.BANDS[i % len(parts.BANDS)]
        for side in (-1, 1):
            ends = (f"cell {i + 1}.{side}.in", f"cell {i + 1}.{side}.out")
            parts.site(before, ends[0], (at[0], side * wide * (1 + i), at[2]))
            parts.site(block, ends[1], (0.0, side * wide * (1 + i), 0.0))
            parts.between(model, f"cell {i + 1}.{side}", ends, width=0.0015, rgba=colour)
        before, at = block, np.zeros(3)


def _ball(model: Any, hopper: Hopper, at: Floats, touch: dict[str, Any]) -> None:
    out = out_of(hopper)
    start = at + place_of(hopper, hopper.foot_after - 1) + (THICK + BALL) * np.array(out)
    ball = model.worldbody.add_body(name="ball", pos=start)
    parts.slider(ball, "ball", out)
    look = {"rgba": parts.SUPPORT, "priority": 1, **parts.STANDS, **touch}
    parts.ball(ball, BALL, mass=hopper.ball_mass, **look)
