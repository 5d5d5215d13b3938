"""`stepwell schema`: what the JSON of every command holds, as JSON Schema."""

import json
from typing import Annotated

import typer

from stepwell.cli.options import completing
from stepwell.cli.screen import show_lines, show_verbatim, usable


def schema(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="RESULT",
            help="Which result, such as run or lab.read; a list of all by default.",
            autocompletion=completing.results,
        ),
    ] = None,
) -> None:
    """Print the JSON Schema of a result.

    Every JSON that a command prints or writes names its schema and the version of it, as in
    stepwell.run/2; this prints that schema, for programs that read results.
    """
    from stepwell.accounts import schema_kinds, schema_of

    if kind is None:
        names = (schema_of(one)["title"] for one in schema_kinds())
        show_lines("Results, each with the version of its schema", "", *names)
        return
    with usable("RESULT"):
        found = schema_of(kind)
    show_verbatim(json.dumps(found, indent=2))
