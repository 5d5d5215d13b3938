"""An arena as the text of its file."""

from __future__ import annotations

from stepwell.files.schema import arena as schema, table_lines
from stepwell.robot import Arena
from stepwell.robot.parts import of_arena


def arena_text_of(arena: Arena) -> str:
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
