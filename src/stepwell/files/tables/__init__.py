"""The tables of a design file as values, and back."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.files.tables.cells import Shared, cells_of, chain_of
from stepwell.files.tables.known import columns_of, known_keys, new_cells
from stepwell.files.tables.program import WrittenProgram, program_of

if TYPE_CHECKING:
    from stepwell.files.tables.arena_map import drawn
    from stepwell.files.tables.design_text import chain_text, robot_text
    from stepwell.files.tables.robots import part_of, robot
    from stepwell.files.tables.tree import is_number, leaves, set_leaf, sources, tree_of


def __getattr__(name: str) -> Any:
    # What reads robots and writes files opens when it is asked for, not with the first chain.
    for part in () if name.startswith("_") else ("robots", "design_text", "arena_map", "tree"):
        offered = vars(import_module(f"stepwell.files.tables.{part}"))
        if name in offered:
            return offered[name]
    raise AttributeError(f"module 'stepwell.files.tables' has no attribute {name!r}")
