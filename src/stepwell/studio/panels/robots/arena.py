"""Arenas: those that come along, one of them or of a file of the user's, and the file of one."""

from __future__ import annotations

from stepwell import files
from stepwell.base import InputError
from stepwell.studio.panels.robots._arena import arena_of
from stepwell.studio.wire import LONGEST_MESSAGE, Ask, Design, View


def answer(_design: Design, ask: Ask) -> View:
    """The list; or the tables of the arena of a `name` or a `text`; or the file of an `arena`.

    The text is all there is of a file: no name in it is ever opened.
    """
    if ask.has("arena"):
        arena = arena_of(ask)
        ask.close()
        assert arena is not None
        return View({"toml": files.dumps(arena)})
    if ask.has("name"):
        text = files.arena_text(ask.text("name", 200))
    elif ask.has("text"):
        text = ask.text("text", LONGEST_MESSAGE)
    else:
        ask.close()
        return View({"arenas": [{"name": n, "title": t} for n, t in files.arenas().items()]})
    ask.close()
    if not text.strip():
        raise InputError("ask.text: is empty; it must be an arena's file or a map of letters.")
    arena = files.loads_arena(text)
    return View({"arena": files.arena_tables(arena), "title": arena.title})
