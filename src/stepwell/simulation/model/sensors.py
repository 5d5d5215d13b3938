"""What is read from the simulation at every sample, by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.robot import Arena, Robot
from stepwell.simulation.model.simulator import Model, mujoco

TYPE = mujoco.mjtSensor
OBJECT = mujoco.mjtObj


def rod_names(robot: Robot) -> Iterator[str]:
    """Lines of fixed length: a stretched one is the first sign of a run that goes wrong."""
    for leg in robot.legs:
        yield from (f"{leg.name}.{cell}.lever" for cell in leg.chain.names)
        yield from (f"{leg.name}.link.{end}" for end in ("in", "out"))


def obstacle_names(arena: Arena) -> tuple[str, ...]:
    """What the model calls the obstacles: walls first, numbered from 1."""
    walls = (f"wall {i + 1}" for i in range(len(arena.walls)))
    return (*walls, *(f"cylinder {i + 1}" for i in range(len(arena.cylinders))))


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
    """Where each sensor's numbers stand among all of them."""
    return {
        model.sensor(i).name: slice(int(start), int(start + size))
        for i, (start, size) in enumerate(zip(model.sensor_adr, model.sensor_dim, strict=True))
    }


def contacts(model: Model) -> Ints:
    """(m,) columns that are forces of what touches."""
    touches = np.flatnonzero(model.sensor_type == int(TYPE.mjSENS_TOUCH))
    return np.asarray(model.sensor_adr[touches], np.int64)


def sampled(readings: Floats, pending: Floats, every: int, columns: Ints) -> tuple[Floats, Floats]:
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
