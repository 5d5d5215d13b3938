"""Design files in and out, and results as files: read, check, write."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.base import write_atomic
from stepwell.files.curves import load_element
from stepwell.files.design import (
    load,
    load_chain,
    load_program,
    load_robot,
    loads,
    loads_chain,
    loads_program,
    loads_robot,
    loads_tables,
    preset,
    preset_text,
    presets,
    tables_in,
    text_of,
)
from stepwell.files.folder import (
    IncompleteError,
    OverwriteError,
    check_folder,
    digest,
    manifest,
    staged_folder,
)
from stepwell.files.lock import BusyError
from stepwell.files.outputs import OUTPUTS, extras_of, pictures
from stepwell.files.schema import slips_text
from stepwell.files.tables import WrittenProgram
from stepwell.files.text import DesignError

if TYPE_CHECKING:
    from stepwell.files.arena import (
        arena_tables,
        arena_text,
        arenas,
        load_arena,
        loads_arena,
        loads_arena_tables,
    )
    from stepwell.files.rig import loads_rig, rig_toml
    from stepwell.files.robot_parameters import Given, key_unit, parameters, provenance, vary
    from stepwell.files.write import dumps, save, with_program

__all__ = [
    "OUTPUTS",
    "BusyError",
    "DesignError",
    "Given",
    "IncompleteError",
    "OverwriteError",
    "WrittenProgram",
    "arena_tables",
    "arena_text",
    "arenas",
    "check_folder",
    "digest",
    "dumps",
    "extras_of",
    "key_unit",
    "load",
    "load_arena",
    "load_chain",
    "load_element",
    "load_program",
    "load_robot",
    "loads",
    "loads_arena",
    "loads_arena_tables",
    "loads_chain",
    "loads_program",
    "loads_rig",
    "loads_robot",
    "loads_tables",
    "manifest",
    "parameters",
    "pictures",
    "preset",
    "preset_text",
    "presets",
    "provenance",
    "rig_toml",
    "text_of",
    "save",
    "slips_text",
    "staged_folder",
    "tables_in",
    "vary",
    "with_program",
    "write_atomic",
]


def __getattr__(name: str) -> Any:
    # What reads robots and arenas and writes files opens when it is asked for.
    for part in ("arena", "rig", "robot_parameters", "write") if name in __all__ else ():
        offered = vars(import_module(f"stepwell.files.{part}"))
        if name in offered:
            return offered[name]
    raise AttributeError(f"module 'stepwell.files' has no attribute {name!r}")
