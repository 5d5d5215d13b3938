"""`stepwell export` and `stepwell view`: a robot's MuJoCo model in a file, or on the screen."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stepwell.cli.options import (
    Arena as ArenaName,
    ForceFile,
    Robot as RobotName,
    free_file,
    local,
    read_robot,
)
from stepwell.cli.screen import has_display, show_verbatim, usable

if TYPE_CHECKING:
    from stepwell.robot import Arena, Robot

NO_DISPLAY = (
    "There is no display here, and the viewer is a window. `stepwell walk` and `stepwell maze` "
    "write videos without one; `stepwell export` writes a model to look at elsewhere."
)


def export(
    robot: RobotName,
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE.xml",
            help="The file to write.",
            show_default=False,
            callback=local,
        ),
    ] = Path("robot.xml"),
    arena: ArenaName = None,
    force: ForceFile = False,
) -> None:
    """Export a robot as MJCF, the format of MuJoCo.

    MuJoCo's own viewer opens it and shows bands, levers, links and antennas. In its keyframe
    `start` the robot stands on the floor with every cell at 0.
    """
    from stepwell import files, simulation

    free_file(out, force)
    _, design = read_robot(robot)
    place = files.load_arena(arena) if arena is not None else None
    with usable(robot):
        text = simulation.mjcf(design, place)
    files.write_atomic(out, text)
    show_verbatim(f"Wrote {out}")


def view(robot: RobotName, arena: ArenaName = None) -> None:
    """Simulate a robot in MuJoCo's viewer.

    The viewer needs a display. The actuator follows its command, and the mouse can push the robot.
    """
    from stepwell import files

    _, design = read_robot(robot)
    place = files.load_arena(arena) if arena is not None else None
    if not has_display():
        typer.echo(NO_DISPLAY, err=True)
        raise typer.Exit(1)
    with usable(robot):
        _show(design, place)


def command(robot: Robot, settle: float) -> Callable[[Any, Any], None]:
    """What MuJoCo calls at every step: the stroke wanted at that time, 0 while it settles."""

    def control(_model: Any, data: Any) -> None:
        data.ctrl[0] = robot.drive.stroke(data.time - settle)

    return control


def model(robot: Robot, arena: Arena | None) -> tuple[Any, Any]:
    """The compiled model, and its data standing at the start."""
    from stepwell.simulation import mujoco, spec

    compiled = spec(robot, arena).compile()
    data = mujoco.MjData(compiled)
    mujoco.mj_resetDataKeyframe(compiled, data, 0)
    return compiled, data


def _show(robot: Robot, arena: Arena | None) -> None:
    """Open the viewer, and come back when it is closed."""
    from importlib import import_module

    from stepwell.simulation import Settings, mujoco

    viewer = import_module("mujoco.viewer")
    compiled, data = model(robot, arena)
    mujoco.set_mjcb_control(command(robot, Settings().settle))
    try:
        viewer.launch(compiled, data)
    finally:
        mujoco.set_mjcb_control(None)
