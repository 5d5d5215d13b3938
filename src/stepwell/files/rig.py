"""The rig of a test machine from a file, and to one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pydantic import ValidationError

from stepwell.files.schema import fields, refused, rig as schema, table_lines
from stepwell.files.text import parsed

if TYPE_CHECKING:
    from stepwell.lab import Rig

_EMPTY = "is empty: a rig is what `stepwell lab calibrate` writes, as in stretch = 1.02"


def loads_rig(text: str, name: str = "rig") -> Rig:
    """The rig that a text describes, in SI.

    Args:
        text: TOML, as `stepwell lab calibrate` writes it; without bar_mm the machine moves with the
            block.
        name: what messages call it.

    Raises:
        DesignError: the text is none, or asks for what no rig can be; its own text has one line for
            every problem.
    """
    from stepwell.lab import Rig

    try:
        keys = schema.RigKeys.model_validate(parsed(text, name, _EMPTY))
    except ValidationError as error:
        raise refused(name, error, schema.TABLES) from None
    return Rig(**fields(keys))


def rig_toml(rig: Rig) -> str:
    """The file of a rig; an infinite bar is left out."""
    lines = table_lines(schema.RigKeys, rig, ["bar_mm"] if math.isinf(rig.bar) else [])
    return "\n".join(lines) + "\n"
