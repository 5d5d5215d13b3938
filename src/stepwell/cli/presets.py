"""`stepwell presets` and `stepwell new`: the designs that come along, and a copy of one."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.accounts import account
from stepwell.cli.options import ForceFile, completing, free_file, local
from stepwell.cli.screen import report, show_lines


def presets(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """List the designs that come with Stepwell.

    The paper's come first, then some that go further, then robots.
    """
    from stepwell import files

    report(account(files.presets()), as_json)


def new(
    file: Annotated[
        Path, typer.Argument(metavar="NAME.toml", help="The file to write.", callback=local)
    ],
    preset: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Which design; see `stepwell presets`.",
            autocompletion=completing.presets,
        ),
    ] = "paper-forward",
    force: ForceFile = False,
) -> None:
    """Write a design file to start from.

    It is a copy of one of the designs that come with Stepwell, with its comments.
    """
    from stepwell import files

    if file.suffix != ".toml":
        raise typer.BadParameter(
            f"must end in .toml, as in {file.stem}.toml.", param_hint=str(file)
        )
    free_file(file, force)
    files.write_atomic(file, files.preset_text(preset))
    command = "walk" if preset.startswith("robot-") else "run"
    show_lines(f"Wrote {file}. Next: stepwell {command} {file}")
