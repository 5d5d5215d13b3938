"""MuJoCo's viewer with the actuator's command applied."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Any

from stepwell.robot import Arena, Robot

NO_DISPLAY = (
    "There is no display here, and the viewer is a window. `stepwell walk` and `stepwell maze` "
    "write videos without one; `stepwell export` writes a model to look at elsewhere."
)


def has_display() -> bool:
    """Whether windows can open; elsewhere than on Linux one has to try."""
    screens = ("DISPLAY", "WAYLAND_DISPLAY")
    return sys.platform != "linux" or any(os.environ.get(name) for name in screens)


def command(robot: Robot, settle: float) -> Callable[[Any, Any], None]:
    """What MuJoCo calls at every step: the stroke wanted at that time, 0 while it settles."""

    def control(_model: Any, data: Any) -> None:
        data.ctrl[0] = robot.drive.stroke(data.time - settle)

    return control


def model(robot: Robot, arena: Arena | None) -> tuple[Any, Any]:
    """The compiled model, and its data standing at the start."""
    from stepwell.simulation import spec
    from stepwell.simulation.model import mujoco

    compiled = spec(robot, arena).compile()
    data = mujoco.MjData(compiled)
    mujoco.mj_resetDataKeyframe(compiled, data, 0)
    return compiled, data


def show(robot: Robot, arena: Arena | None) -> None:
    """Open the viewer, and come back when it is closed."""
    from importlib import import_module

    from stepwell.simulation import Settings
    from stepwell.simulation.model import mujoco

    viewer = import_module("mujoco.viewer")
    compiled, data = model(robot, arena)
    mujoco.set_mjcb_control(command(robot, Settings().settle))
    try:
        viewer.launch(compiled, data)
    finally:
        mujoco.set_mjcb_control(None)
