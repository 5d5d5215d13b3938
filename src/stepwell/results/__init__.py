"""Results as plain numbers with the unit in every name.

Every `…_record` takes a result and returns what JSON can hold of it, as docs/commands.md describes
it. `design` is the text of its design file, for the hash of it; written anew by default.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.accounts import actuator_words, assumptions, head, simulation_assumptions, tie_notes
from stepwell.results.json_schema import schema_kinds, schema_of

if TYPE_CHECKING:
    from stepwell.results.atlas import (
        ATLAS_MACHINES,
        atlas_assumed,
        atlas_facts,
        atlas_record,
        memory_words,
    )
    from stepwell.results.study import (
        STUDY_DECIDED,
        STUDY_OUTCOME,
        deciding_rows,
        missing_text,
        screen_facts,
        study_record,
    )

__all__ = [
    "assumptions",
    "head",
    "schema_kinds",
    "schema_of",
    "simulation_assumptions",
    "atlas_record",
    "study_record",
]


def __getattr__(name: str) -> Any:
    # Studies and atlases open their rooms when their results are asked for.
    for part in () if name.startswith("_") else ("atlas", "study"):
        offered = vars(import_module(f"stepwell.results.{part}"))
        if name in offered:
            return offered[name]
    raise AttributeError(f"module 'stepwell.results' has no attribute {name!r}")
