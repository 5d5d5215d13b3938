"""A design to begin with: one that comes along, or the text of a file of the user's."""

from __future__ import annotations

from stepwell import files
from stepwell.base import InputError
from stepwell.studio.wire import LONGEST_MESSAGE, Ask, Design, View


def answer(_design: Design, ask: Ask) -> View:
    """The tables of the design and its title.

    The text is all there is of a file: no name in it is ever opened.
    """
    if ask.has("preset") == ask.has("toml"):
        raise InputError("ask: must have preset, a name of the gallery, or toml, a file's text.")
    if ask.has("preset"):
        text, name = files.preset_text(ask.text("preset", 200)), "preset"
    else:
        text, name = ask.text("toml", LONGEST_MESSAGE), "design"
    ask.close()
    tables = files.tables_in(text, name)
    return View({"design": tables, "title": tables.get("title", "")})
