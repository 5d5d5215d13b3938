"""Reading, checking and writing of design files, and folders of results."""

from typing import TYPE_CHECKING

from stepwell.base import late, write_atomic
from stepwell.files.curves import load_element
from stepwell.files.design import (
    DesignFile,
    Presets,
    load,
    loads,
    loads_tables,
    preset,
    preset_text,
    presets,
    tables_in,
    text_of,
)
from stepwell.files.folder import (
    BusyError,
    IncompleteError,
    OverwriteError,
    check_folder,
    digest,
    manifest,
    staged_folder,
)
from stepwell.files.outputs import OUTPUTS, extras_of, pictures
from stepwell.files.program import WrittenProgram
from stepwell.files.schema import keys
from stepwell.files.schema.keys import slips_text
from stepwell.files.schema.wording import checked
from stepwell.files.text import DesignError, did_you_mean, parsed

if TYPE_CHECKING:
    from stepwell.files.arena import (
        arena_tables,
        arena_text,
        arenas,
        load_arena,
        loads_arena,
        loads_arena_tables,
        vary_arena,
    )
    from stepwell.files.behaviour import behaviour_text, behaviours, load_behaviour, loads_behaviour
    from stepwell.files.hoppers import hopper_parameters
    from stepwell.files.known import columns_of, known_keys, new_cells
    from stepwell.files.machine import load_machine, machine_text, machines
    from stepwell.files.robot_parameters import (
        RobotParameter,
        key_unit,
        parameters,
        provenance,
        vary,
    )
    from stepwell.files.write import dumps, loads_rig, rig_toml, save, with_program

__all__ = [
    "OUTPUTS",
    "BusyError",
    "DesignError",
    "DesignFile",
    "Presets",
    "RobotParameter",
    "IncompleteError",
    "OverwriteError",
    "WrittenProgram",
    "arena_tables",
    "arena_text",
    "arenas",
    "behaviour_text",
    "behaviours",
    "check_folder",
    "digest",
    "dumps",
    "extras_of",
    "hopper_parameters",
    "key_unit",
    "load",
    "load_arena",
    "load_behaviour",
    "load_element",
    "load_machine",
    "loads",
    "loads_arena",
    "loads_arena_tables",
    "loads_behaviour",
    "loads_rig",
    "loads_tables",
    "machine_text",
    "machines",
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

# Modules for robots, arenas and writing are imported at first use.
_LATE = {
    "arena": (
        "arena_tables",
        "arena_text",
        "arenas",
        "load_arena",
        "loads_arena",
        "loads_arena_tables",
        "vary_arena",
    ),
    "hoppers": ("hopper_parameters",),
    "behaviour": ("behaviour_text", "behaviours", "load_behaviour", "loads_behaviour"),
    "machine": ("load_machine", "machine_text", "machines"),
    "known": ("columns_of", "known_keys", "new_cells"),
    "robot_parameters": ("RobotParameter", "key_unit", "parameters", "provenance", "vary"),
    "write": ("dumps", "loads_rig", "rig_toml", "save", "with_program"),
}


__getattr__, __dir__ = late(__name__, _LATE, __all__)
