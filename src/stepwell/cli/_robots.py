"""What the robot's commands share: their arguments, and a wrong one said in a line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

Robot = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A robot's design file (TOML), or the name of one of `stepwell presets`.",
        show_default=False,
    ),
]
NoVideo = Annotated[bool, typer.Option("--no-video", help="Write the figures alone.")]


def named(robot: str) -> str:
    """A robot as `files.load_robot` takes it: a preset may be told by its name alone."""
    from stepwell import files

    short = robot in files.presets() and not Path(robot).exists()
    return f"preset:{robot}" if short else robot


@contextmanager
def usable(what: str) -> Iterator[None]:
    """Turn what the simulation cannot do with an argument into wrong usage."""
    from stepwell.files import DesignError

    try:
        yield
    except DesignError:
        raise
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint=what) from None
