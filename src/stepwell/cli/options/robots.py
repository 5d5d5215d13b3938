"""Arguments that the robot's commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.screen import usable as usable

Robot = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A robot's design file (TOML), or the name of one of `stepwell presets`.",
    ),
]
NoVideo = Annotated[bool, typer.Option("--no-video", help="Write the figures alone.")]


def named(robot: str) -> str:
    """A robot as `files.load_robot` takes it: a preset may be told by its name alone."""
    from stepwell import files

    short = robot in files.presets() and not Path(robot).exists()
    return f"preset:{robot}" if short else robot
