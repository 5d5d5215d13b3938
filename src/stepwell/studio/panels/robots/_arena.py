"""What a run is asked with: an arena as its file has it, and how long it is to go on."""

from __future__ import annotations

from stepwell import files
from stepwell.base import InputError
from stepwell.robot import Arena
from stepwell.studio.wire import Ask

_MOST_CYCLES = 1000
_LONGEST = 3600.0  # s


def arena_of(ask: Ask) -> Arena | None:
    """The arena that is asked with, or None for a bare floor.

    Raises:
        ValueError: one that cannot be; the text as for a file.
    """
    return files.loads_arena_tables(ask.table("arena")) if ask.has("arena") else None


def walk_asked(ask: Ask) -> tuple[Arena | None, float]:
    """Where a robot is to walk, and for how many cycles.

    Raises:
        ValueError: an arena that cannot be, or too many cycles.
    """
    arena, cycles = arena_of(ask), ask.number("cycles", 0.01, _MOST_CYCLES, 8.0)
    ask.close()
    return arena, cycles


def maze_asked(ask: Ask) -> tuple[Arena, float]:
    """Which arena a robot is to go through, and in what time [s].

    Raises:
        ValueError: none, one that cannot be, or too much time.
    """
    arena, limit = arena_of(ask), ask.number("limit_s", 1.0, _LONGEST, 600.0)
    ask.close()
    if arena is None:
        raise InputError("ask.arena: is missing; a maze needs one, if only the open floor.")
    return arena, limit
