"""The keys of a rig's file: what each may hold, and in which unit."""

from __future__ import annotations

from decimal import Decimal
from typing import Annotated

from stepwell.files.schema.checks import Keys, above_zero, bounded, tables_of

Start = Annotated[Decimal, bounded("-10", "10")]


class RigKeys(Keys):
    """What lies between a test machine and a mechanism."""

    bar_mm: Annotated[Decimal, bounded("20", "1e6")] | None = None
    stretch: Annotated[Decimal, above_zero("0.5", "2")] | None = None
    start_loading_mm: Start | None = None
    start_unloading_mm: Start | None = None
    compliance_mm_per_N: Annotated[Decimal, bounded("0", "1e3")] | None = None
    friction_N: Annotated[Decimal, bounded("0", "1e6")] | None = None


TABLES = tables_of(RigKeys)
