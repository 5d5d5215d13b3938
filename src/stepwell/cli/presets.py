"""`stepwell presets`: the designs that come with the package."""

from typing import Annotated

import typer

from stepwell.cli.screen import finish, show_table

_Json = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]


def presets(as_json: _Json = False) -> None:
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
