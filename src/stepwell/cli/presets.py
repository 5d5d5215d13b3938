"""`stepwell presets` and `stepwell new`: the designs that come along, and a copy of one."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import ForceFile, completing, free_file, local
from stepwell.cli.screen import finish, show_lines, show_table


def presets(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """List the designs that come with Stepwell.

    The paper's come first, then some that go further, then robots.
    """
    from stepwell import files

    found = files.presets()
    rows = [{"name": name, "title": title} for name, title in found.items()]
    finish(
        {"schema": "stepwell.presets/1", "presets": rows},
        lambda _: show_table("Designs", ["name", "what it is"], list(found.items()), left=(0, 1)),
        as_json,
    )


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
