"""`stepwell studio`: a page on which a design is dragged and everything follows."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import completing, local
from stepwell.cli.screen import Interrupted, show_verbatim


def studio(
    design: Annotated[
        str | None,
        typer.Argument(
            metavar="[DESIGN]",
            help="What the page shows first: a design file (TOML), or preset:NAME; the gallery by "
            "default.",
            autocompletion=completing.designs,
        ),
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            help="The port on this machine, 0 for any; by default 7473, where the browser finds "
            "the last design again, or any free one.",
            min=0,
            max=65535,
            show_default=False,
        ),
    ] = None,
    studies: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Where the page finds and keeps studies; by default a folder of your own data.",
            file_okay=False,
            show_default=False,
            callback=local,
        ),
    ] = None,
    demo: Annotated[
        bool, typer.Option("--demo", help="Begin with a guided tour of two minutes.")
    ] = False,
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Say the page's address and open no browser.")
    ] = False,
) -> None:
    """Open a page on which a design is dragged and everything follows.

    Mechanism, force, sequence and margins, all from the same engine as the other commands. Only
    this machine can reach it, with the address that is printed. Ctrl-C ends it.
    """
    from stepwell import files, studio as room

    tables = None
    if design is not None:
        text = files.text_of(design)
        files.loads(text, design)  # which refuses what cannot be
        tables = files.tables_in(text, design)

    def opened(address: str) -> None:
        address += "&demo=1" if demo else ""
        show_verbatim(address)
        if not no_open:
            webbrowser.open(address)

    try:
        room.serve(tables, port=port, studies=studies, opened=opened)
    except KeyboardInterrupt:
        raise Interrupted("The studio has ended; an open page keeps its design.") from None
