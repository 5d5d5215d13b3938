"""A chain, a robot or an arena in, its file out."""

from __future__ import annotations

import os

from stepwell.files._arena_text import arena_text_of
from stepwell.files._chain_text import chain_text
from stepwell.files._robot_text import robot_text
from stepwell.files.arena import loads_arena
from stepwell.files.atomic import write_atomic
from stepwell.files.design import loads
from stepwell.mechanism import Chain
from stepwell.robot import Arena, Robot


def save(design: Chain | Robot | Arena, path: str | os.PathLike[str]) -> None:
    """Write a chain, a robot or an arena as its file, whole or not at all.

    Args:
        design: any chain, robot or arena.
        path: where to, as TOML; an existing file is replaced.

    Raises:
        ValueError: the design lies outside what its file may hold, or an arena is to be a map.
        OSError: the folder is missing or cannot be written.
    """
    if isinstance(design, Arena) and os.fspath(path).endswith(".txt"):
        raise ValueError(f"{os.fspath(path)}: an arena is written as TOML: let it end in .toml.")
    write_atomic(path, dumps(design))


def dumps(design: Chain | Robot | Arena) -> str:
    """The file of a chain, a robot or an arena; reading it gives an equal one, to the last bit.

    Args:
        design: any chain, robot or arena.

    Returns:
        TOML: what cells and legs share first, then each of them, innermost first.

    Raises:
        ValueError: the design lies outside what its file may hold, such as a name of two lines
            or a lever of a thousand kilometres.
    """
    if isinstance(design, Arena):
        text = arena_text_of(design)
        again = loads_arena(text, "this arena, written as a file")
    elif isinstance(design, Robot):
        text = robot_text(design)
        again = loads(text, "this robot, written as a design file")
    else:
        text = chain_text(design)
        again = loads(text, "this chain, written as a design file")
    if again != design:
        raise ValueError(f"{design!r} did not survive being written: please report this design.")
    return text
