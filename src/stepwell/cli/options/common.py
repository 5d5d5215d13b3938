"""Arguments that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

Design = Annotated[
    str,
    typer.Argument(
        metavar="DESIGN",
        help="A design file (TOML), or preset:NAME for a design of `stepwell presets`.",
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        "-o",
        metavar="DIR",
        help="Write the results into this folder.",
        file_okay=False,
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
