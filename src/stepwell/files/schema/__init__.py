"""The keys of design files: what each may hold, and in which unit."""

from stepwell.files.schema import arena, chain, elements, rig, robot
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
from stepwell.files.schema.robot import ASSUMED
from stepwell.files.schema.wording import refused
