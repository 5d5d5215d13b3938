"""The arena of a request: tables as its file has them."""

from __future__ import annotations

from stepwell import files
from stepwell.robot import Arena
from stepwell.studio.wire import Ask


def arena_of(ask: Ask) -> Arena | None:
    """The arena that is asked with, or None for a bare floor.

    Raises:
        ValueError: one that cannot be; the text as for a file.
    """
    return files.loads_arena_tables(ask.table("arena")) if ask.has("arena") else None
