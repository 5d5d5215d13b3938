"""What is read from the simulation at every sample, by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepwell.robot import Arena, Robot
from stepwell.simulation.model.arena import obstacle_names
from stepwell.simulation.model.simulator import Model, mujoco

Array = NDArray[np.float64]

TYPE = mujoco.mjtSensor
OBJECT = mujoco.mjtObj


def rod_names(robot: Robot) -> Iterator[str]:
    """Lines of fixed length: a stretched one is the first sign of a run that goes wrong."""
    for leg in robot.legs:
        yield from (f"{leg.name}.{cell}.lever" for cell in leg.chain.names)
        yield from (f"{leg.name}.link.{end}" for end in ("in", "out"))


def add_sensors(spec: Any, robot: Robot, arena: Arena | None) -> None:
    """Add every sensor that a recording needs."""

    def add(name: str, kind: Any, target: str, what: Any) -> None:
        spec.add_sensor(name=name, type=kind, objname=target, objtype=what)

    add("body.position", TYPE.mjSENS_FRAMEPOS, "body", OBJECT.mjOBJ_XBODY)
    add("body.attitude", TYPE.mjSENS_FRAMEQUAT, "body", OBJECT.mjOBJ_XBODY)
    add("stroke", TYPE.mjSENS_JOINTPOS, "stroke", OBJECT.mjOBJ_JOINT)
    add("drive", TYPE.mjSENS_ACTUATORFRC, "drive", OBJECT.mjOBJ_ACTUATOR)
    for leg in robot.legs:
        for cell in leg.chain.names:
            travel = f"{leg.name}.{cell}.travel"
            add(travel, TYPE.mjSENS_TENDONPOS, travel, OBJECT.mjOBJ_TENDON)
        tip = f"{leg.name}.tip"
        add(f"{tip}.position", TYPE.mjSENS_FRAMEPOS, tip, OBJECT.mjOBJ_SITE)
        add(f"{tip}.velocity", TYPE.mjSENS_FRAMELINVEL, tip, OBJECT.mjOBJ_SITE)
        sole = f"{leg.name}.sole"
        add(sole, TYPE.mjSENS_TOUCH, sole, OBJECT.mjOBJ_SITE)
    for i in range(len(robot.body.supports)):
        add(f"support {i + 1}", TYPE.mjSENS_TOUCH, f"support {i + 1}", OBJECT.mjOBJ_SITE)
    for antenna in robot.antennas:
        swing, feeler = f"{antenna.name}.antenna", f"{antenna.name}.feeler"
        add(swing, TYPE.mjSENS_JOINTPOS, swing, OBJECT.mjOBJ_JOINT)
        add(feeler, TYPE.mjSENS_TOUCH, feeler, OBJECT.mjOBJ_SITE)
    for name in obstacle_names(arena) if arena is not None else ():
        add(name, TYPE.mjSENS_TOUCH, name, OBJECT.mjOBJ_SITE)
    rods = {tendon.name for tendon in spec.tendons}
    for name in rod_names(robot):
        if name in rods:
            add(f"{name}.length", TYPE.mjSENS_TENDONPOS, name, OBJECT.mjOBJ_TENDON)


def columns(model: Model) -> dict[str, slice]:
    """Where each sensor's numbers stand among all of them."""
    return {
        model.sensor(i).name: slice(int(start), int(start + size))
        for i, (start, size) in enumerate(zip(model.sensor_adr, model.sensor_dim, strict=True))
    }


def contacts(model: Model) -> NDArray[np.intp]:
    """(m,) columns that are forces of what touches."""
    touches = np.flatnonzero(model.sensor_type == int(TYPE.mjSENS_TOUCH))
    return np.asarray(model.sensor_adr[touches], np.intp)


def sampled(
    readings: Array, pending: Array, every: int, columns: NDArray[np.intp]
) -> tuple[Array, Array]:
    """The readings of every so many steps, forces of what touches as means over these steps.

    Between two samples feet land and lift; what one carries at an instant says little of it.

    Args:
        readings: (..., n, sensors) of each step.
        pending: (..., m, sensors) of the m < `every` steps since the last sample.
        every: steps to a sample.
        columns: (k,) of these forces.

    Returns:
        The samples (..., (m + n) // every, sensors), and the steps since the last of them.
    """
    steps = np.concatenate([pending, readings], axis=-2)
    *some, n, width = steps.shape
    end = n - n % every
    windows = steps[..., :end, :].reshape(*some, n // every, every, width)
    found = windows[..., -1, :].copy()
    # What overflows is found by who looks at the samples.
    with np.errstate(over="ignore", invalid="ignore"):
        found[..., columns] = windows[..., columns].mean(axis=-2)
    return found, steps[..., end:, :].copy()
