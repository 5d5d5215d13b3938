"""The keys of design files: what each may hold, and in which unit."""

from typing import TYPE_CHECKING

from stepwell.files.schema import chain, elements
from stepwell.files.schema.checks import Within
from stepwell.files.schema.keys import (
    UNITS,
    field_of,
    fields,
    key_of,
    si,
    slip_lines,
    slip_text,
    slips_text,
    table_lines,
    unit_of,
    written,
)
from stepwell.files.schema.wording import refused

if TYPE_CHECKING:
    # Opened where one of these files is read: a chain needs none of them.
    from stepwell.files.schema import arena, rig, robot
