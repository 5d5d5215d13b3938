"""Size limits of inputs, and the environment variable that raises them."""

import os
import stat
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from stepwell.base.errors import InputError, SettingError, nearest_word

VARIABLE = "STEPWELL_LIMITS"


class Limit(NamedTuple):
    """The largest number allowed, and the name of the things counted."""

    most: int
    of: str


# Parts of a design, sizes of a computation, lengths of files. docs/limits.md has the table and the
# reasons.
LIMITS = {
    "cells": Limit(10_000, "cells in a chain"),
    "bands": Limit(100, "bands on a cell"),
    "rows": Limit(10_000, "rows of a table"),
    "turns": Limit(10_000, "turning points"),
    "legs": Limit(100, "legs of a robot"),
    "antennas": Limit(100, "antennas of a robot"),
    "supports": Limit(1000, "supports of a body"),
    "obstacles": Limit(1000, "walls and cylinders in an arena"),
    "patches": Limit(100, "patches and plates in an arena"),
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
    "built_cells": Limit(8, "cells of a build"),
}


def most(name: str) -> int:
    """The current limit; raises SettingError if STEPWELL_LIMITS is invalid."""
    text = os.environ.get(VARIABLE, "")
    return _raised(text).get(name, LIMITS[name].most)


def require(name: str, count: float, what: str = "") -> None:
    """Raise ValueError, with the setting that allows more, if `count` exceeds a limit.

    `what` is the subject of the message: the part that has them, or the source of the number.
    """
    if count > most(name):
        raise InputError(problem(name, count, what))


def problem(name: str, count: float, what: str = "", *, so_far: bool = False) -> str:
    """The message for a count over its limit; `so_far` if counting is not finished."""
    shown = f"{count:.0f}" if count < 1e18 else f"{count:.3g}"
    raised = f"{most(name) * 10}" if so_far or count >= 1e18 else shown
    return (
        f"{what}{' ' if what else ''}{shown} {LIMITS[name].of}: at most {most(name)} are taken; "
        f"{VARIABLE}={name}={raised} in the environment allows {'more' if so_far else 'as many'}."
    )


def content_of(path: Path, name: str) -> bytes:
    """The content of a regular file within the limit `name`; raises OSError otherwise."""
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
