"""How big an input may be, and how somebody who means it allows more."""

import os
import stat
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from stepwell.base.errors import InputError, SettingError, nearest_word

VARIABLE = "STEPWELL_LIMITS"


class Limit(NamedTuple):
    """The most that is taken of something, and what it is called where it is counted."""

    most: int
    of: str


# What a machine is made of, what may be asked of it, and how long a file is. docs/limits.md has
# the table and the reasons.
LIMITS = {
    "cells": Limit(10_000, "cells in a chain"),
    "bands": Limit(100, "bands on a cell"),
    "rows": Limit(10_000, "rows of a table"),
    "turns": Limit(10_000, "turning points"),
    "legs": Limit(100, "legs of a robot"),
    "antennas": Limit(100, "antennas of a robot"),
    "supports": Limit(1000, "supports of a body"),
    "obstacles": Limit(1000, "walls and cylinders in an arena"),
    "sources": Limit(10_000, "keys of one source"),
    "letters": Limit(160_000, "letters of a map"),
    "depth": Limit(100, "names in one key"),
    "keys": Limit(200_000, "keys of a design file"),
    "design_bytes": Limit(4 << 20, "bytes of a design file"),
    "recording_bytes": Limit(64 << 20, "bytes of a recording"),
    "points": Limit(25_000_000, "places of a map"),
    "samples": Limit(10_000_000, "mechanisms made at random"),
    "robots": Limit(100_000, "robots of a sweep"),
    "steps": Limit(20_000_000, "time steps of a simulated run"),
    "readings": Limit(200_000_000, "readings of a simulated run"),
    "frames": Limit(5000, "frames of a video"),
    "graph_cells": Limit(10, "cells of which all 2^N states are followed"),
    "relays": Limit(20, "cells of which all 2^N states are sorted"),
    "walked": Limit(1_000_000, "nodes of a walk"),
    "branches": Limit(5000, "branches of a transition graph"),
}


def most(name: str) -> int:
    """How many are allowed now; SettingError where STEPWELL_LIMITS cannot be understood."""
    text = os.environ.get(VARIABLE, "")
    return _raised(text).get(name, LIMITS[name].most)


def require(name: str, count: float, what: str = "") -> None:
    """Raise ValueError, with the way to allow them, for more than a limit takes.

    `what` says who has them, and where the number comes from.
    """
    if count > most(name):
        raise InputError(problem(name, count, what))


def problem(name: str, count: float, what: str = "", *, so_far: bool = False) -> str:
    """The sentence that tells that there are too many; `so_far` where they are still counted."""
    shown = f"{count:.0f}" if count < 1e18 else f"{count:.3g}"
    raised = f"{most(name) * 10}" if so_far or count >= 1e18 else shown
    return (
        f"{what}{' ' if what else ''}{shown} {LIMITS[name].of}: at most {most(name)} are taken; "
        f"{VARIABLE}={name}={raised} in the environment allows {'more' if so_far else 'as many'}."
    )


def content_of(path: Path, name: str) -> bytes:
    """The content of an ordinary file that is no longer than the limit of that name, or OSError."""
    kind = path.stat()
    if stat.S_ISDIR(kind.st_mode):
        raise OSError("it is a folder")
    if not stat.S_ISREG(kind.st_mode):
        raise OSError("it is no ordinary file")
    if kind.st_size > most(name):
        raise OSError(problem(name, kind.st_size, "it has").rstrip("."))
    return path.read_bytes()


@lru_cache(maxsize=8)
def _raised(text: str) -> dict[str, int]:
    limits: dict[str, int] = {}
    for part in text.replace(",", " ").split():
        name, _, number = part.partition("=")
        if name not in LIMITS:
            near = nearest_word(name, LIMITS)
            advice = f"Did you mean {near}?" if near else f"Known: {', '.join(LIMITS)}."
            raise SettingError(f"{VARIABLE}: {name[:80]!r} is no limit. {advice}")
        if not (number.isdecimal() and number.isascii() and len(number) < 19 and int(number)):
            raise SettingError(
                f"{VARIABLE}: {part[:80]!r}: must be {name} and a whole number of 1 or more, as in "
                f"{name}={10 * LIMITS[name].most}."
            )
        limits[name] = int(number)
    return limits
