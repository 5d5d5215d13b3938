"""The rig of a test machine from a file, and to one: its keys and its text."""

import math
from decimal import Decimal
from typing import TYPE_CHECKING, Annotated

from stepwell.files.schema.keys import Keys, above_zero, bounded, fields, table_lines
from stepwell.files.schema.wording import checked
from stepwell.files.text import parsed

if TYPE_CHECKING:
    from stepwell.lab import Rig


Start = Annotated[Decimal, bounded("-10", "10")]


class RigKeys(Keys):
    """What lies between a test machine and a mechanism."""

    bar_mm: Annotated[Decimal, bounded("20", "1e6")] | None = None
    stretch: Annotated[Decimal, above_zero("0.5", "2")] | None = None
    start_loading_mm: Start | None = None
    start_unloading_mm: Start | None = None
    compliance_mm_per_N: Annotated[Decimal, bounded("0", "1e3")] | None = None
    friction_N: Annotated[Decimal, bounded("0", "1e6")] | None = None


_EMPTY = "is empty: a rig is what `stepwell lab calibrate` writes, as in stretch = 1.02"


def loads_rig(text: str, name: str = "rig") -> "Rig":
    """The rig that a text describes, in SI.

    Args:
        text: TOML, as `stepwell lab calibrate` writes it; without bar_mm the machine moves with
            the block.
        name: what messages call it.

    Raises:
        DesignError: the text is none, or asks for what no rig can be; a line for every problem.
    """
    from stepwell.lab import Rig

    return Rig(**fields(checked(RigKeys, parsed(text, name, _EMPTY), name)))


def rig_toml(rig: "Rig") -> str:
    """The file of a rig; an infinite bar is left out."""
    lines = table_lines(RigKeys, rig, ["bar_mm"] if math.isinf(rig.bar) else [])
    return "\n".join(lines) + "\n"
