"""Arenas by name or from a file: tables in millimetres, or a map drawn with letters."""

from __future__ import annotations

import os
import re
from functools import cache
from importlib.resources import files
from typing import Any

from pydantic import ValidationError

from stepwell.files.design import text_of
from stepwell.files.schema import arena as schema, fields, refused, slip_lines, table_lines
from stepwell.files.tables import drawn, part_of
from stepwell.files.text import DesignError, did_you_mean, in_decimals, in_floats, parsed
from stepwell.mechanism import SlipError
from stepwell.robot import Arena, Cylinder, Goal, Wall, of_arena

_EMPTY = "is empty: an arena is tables, as in start_mm = [0, 0], or a map below: cell 100 mm"
_SUFFIXES = (".toml", ".txt")


def arenas() -> dict[str, str]:
    """The name of every arena that comes with the package, and its title."""
    return {name: loads_arena(text, f"arena {name}").title for name, text in _texts().items()}


def load_arena(arena: str | os.PathLike[str]) -> Arena:
    """The arena of a name, or the one that a file describes, in SI.

    Args:
        arena: a name that `arenas` lists, for example "three-walls"; or a file that ends in
            .toml or .txt, as docs/design-files.md describes them.

    Raises:
        DesignError: there is none, or its file is wrong; the text has one line for every
            problem.
    """
    name = os.fspath(arena)
    if name in _texts():
        return loads_arena(_texts()[name], f"arena {name}")
    if not name.endswith(_SUFFIXES):
        advice = did_you_mean(name, _texts())
        problem = f"no such arena, and no file that ends in .toml or .txt. {advice}"
        raise DesignError(f"arena {name}", [problem])
    return loads_arena(text_of(arena), name)


def arena_text(name: str) -> str:
    """The file of an arena that comes with the package, a map or TOML, with its comments.

    Args:
        name: as `arenas` lists it.

    Raises:
        DesignError: there is none of that name; the text says which is nearest.
    """
    if name not in _texts():
        raise DesignError(f"arena {name}", [f"no such arena. {did_you_mean(name, _texts())}"])
    return _texts()[name]


def loads_arena(text: str, name: str = "arena") -> Arena:
    """The arena that a text describes, in SI.

    Args:
        text: TOML; or a map, where it starts with the word cell or `name` ends in .txt.
        name: what messages call it.

    Raises:
        DesignError: the text is neither, or asks for what no arena can be; its own text has one
            line for every problem.
    """
    if name.endswith(".txt") or re.match(r"\s*cell\b(?!\s*=)", text):
        return drawn(text, name)
    return _arena(parsed(text, name, _EMPTY), name)


def loads_arena_tables(tables: Any, name: str = "arena") -> Arena:
    """The arena that a file describes whose tables are Python values, as out of JSON.

    Args:
        tables: of strings, numbers, booleans, lists and dictionaries, with the keys of the file;
            none at all are a bare floor.
        name: what messages call it.

    Raises:
        DesignError: as `loads_arena`, with the same words; or a value that no file can hold.
    """
    problems: list[str] = []
    as_read = in_decimals(tables, problems)
    if problems:
        raise DesignError(name, problems)
    return _arena(as_read, name)


def arena_tables(arena: Arena) -> dict[str, Any]:
    """The tables of an arena's file as Python values; `loads_arena_tables` takes them."""
    return in_floats(parsed(arena_toml(arena), "arena", _EMPTY))


def _arena(tables: dict[str, Any], name: str) -> Arena:
    try:
        keys = schema.ArenaKeys.model_validate(tables)
    except ValidationError as error:
        raise refused(name, error, schema.TABLES) from None
    problems: list[str] = []
    walls: list[Any] = [
        part_of(f"wall[{i}]", Wall, fields(one), problems) for i, one in enumerate(keys.wall)
    ]
    if problems:
        raise DesignError(name, problems)
    try:
        cylinders = [Cylinder(**fields(one)) for one in keys.cylinder]
        goal = None if keys.goal is None else Goal(**fields(keys.goal))
        rest = fields(keys, left_out=["wall", "cylinder", "goal"])
        return Arena(walls, cylinders, goal=goal, **rest)
    except SlipError as error:
        raise DesignError(name, slip_lines(error)) from None
    except ValueError as error:
        raise DesignError(name, str(error).split("\n")) from None


def arena_toml(arena: Arena) -> str:
    """The file of an arena: start and goal first, then what stands in the way."""
    left_out = ["goal", "wall", "cylinder", "unusual", *([] if arena.title else ["title"])]
    odd = ["unusual = true"] if arena.unusual or any(of_arena(arena)) else []
    text = [*odd, *table_lines(schema.ArenaKeys, arena, left_out), ""]
    if arena.goal is not None:
        text += ["[goal]", *table_lines(schema.GoalKeys, arena.goal), ""]
    for wall in arena.walls:
        text += ["[[wall]]", *table_lines(schema.WallKeys, wall), ""]
    for cylinder in arena.cylinders:
        text += ["[[cylinder]]", *table_lines(schema.CylinderKeys, cylinder), ""]
    return "\n".join(text).rstrip("\n") + "\n"


@cache
def _texts() -> dict[str, str]:
    folder = files("stepwell.files") / "arenas"
    found = (file for file in folder.iterdir() if file.name.endswith(_SUFFIXES))
    texts = {file.name.rpartition(".")[0]: file.read_text("utf-8") for file in found}
    # From the empty floor to what is hardest.
    order = ("open", "wall", "cylinder", "pen", "three-walls", "corridor")
    return {name: texts[name] for name in order} | texts
