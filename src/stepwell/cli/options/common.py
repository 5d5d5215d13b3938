"""Arguments that several commands share, and what they name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.base import need, refuse_address
from stepwell.cli.options import completing

if TYPE_CHECKING:
    import stepwell.robot as values
    from stepwell.mechanism import Chain

Design = Annotated[
    str,
    typer.Argument(
        metavar="DESIGN",
        help="A design file (TOML), or preset:NAME for a design of `stepwell presets`.",
        autocompletion=completing.designs,
    ),
]
Robot = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A robot's design file (TOML), or the name of one of `stepwell presets`.",
        autocompletion=completing.robots,
    ),
]
Arena = Annotated[
    str | None,
    typer.Option(
        metavar="ARENA",
        help="Put it there; see `stepwell maze --list`.",
        autocompletion=completing.arenas,
    ),
]


def local(out: Path | None) -> Path | None:
    """Where results go, if it is a place on this machine."""
    if out is not None:
        try:
            refuse_address(out)
        except ValueError as error:
            raise typer.BadParameter(str(error)) from None
    return out


Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        "-o",
        metavar="DIR",
        help="Write the results into this folder.",
        file_okay=False,
        callback=local,
    ),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace files that this command did not write so.")
]
ForceFile = Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")]
Json = Annotated[
    bool,
    typer.Option("--json", help="Print JSON and nothing else; docs/commands.md describes it."),
]
Robust = Annotated[
    float | None,
    typer.Option(
        "--robust",
        metavar="RATIO",
        help="Only what works for all mobilities of the cells up to so many times apart, such as "
        "10.",
        min=1,
        max=1e3,
    ),
]
MobilityRatio = Annotated[
    float | None,
    typer.Option(
        "--mobility-ratio",
        metavar="R",
        help="Ask of every snap whether it lands in one place for all mobilities of cells up to so "
        "many times apart; by default 10, for up to 8 cells.",
    ),
]
NoVideo = Annotated[bool, typer.Option("--no-video", help="Write the figures alone.")]


WITHOUT = "Without --out the result is shown, and --json prints all of it."


def read_chain(design: str) -> tuple[str, Chain]:
    """The text of a design file, and the chain that it describes."""
    from stepwell import files

    file = files.load(design)
    return file.text, file.chain


def read_design(design: str) -> tuple[str, Chain | values.Robot]:
    """The text of a design file, and the chain or the robot that it describes."""
    from stepwell import files

    text, design = _by_name(design)
    return text, files.loads(text, design).subject


def read_robot(robot: str) -> tuple[str, values.Robot]:
    """The text of a robot's design file, and the robot; a preset goes by its name alone too."""
    from stepwell import files

    text, robot = _by_name(robot)
    return text, files.loads(text, robot).robot


def _by_name(design: str) -> tuple[str, str]:
    """The text of a design file or of a preset, whose name is enough, and what it is called."""
    from stepwell import files

    if design in files.presets() and not Path(design).exists():
        design = f"preset:{design}"
    return files.text_of(design), design


def free(out: Path | None, command: str, force: bool, **texts: str) -> None:
    """Refuse a folder where results would replace others' work, or cannot be written here.

    Args:
        out: what --out says.
        command: whose results they are.
        force: what --force says.
        texts: of files whose content is known, by their names without .toml.

    Raises:
        ExtraError: what writes them is not installed.
    """
    from stepwell import files

    if out is not None:
        need(*files.extras_of(command), note=WITHOUT)
        known = {f"{name}.toml": text for name, text in texts.items()}
        files.check_folder(out, command, force=force, texts=known)


def free_file(file: Path | None, force: bool) -> None:
    """Refuse a file that exists, unless it may be replaced."""
    if file is not None and file.exists() and not force:
        message = "exists: choose another name, or pass --force to replace it."
        raise typer.BadParameter(message, param_hint=str(file))
