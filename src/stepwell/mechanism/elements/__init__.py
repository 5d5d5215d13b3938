"""Elements: cells that are a force law over their own travel."""

# pyright: reportUnusedImport=false

from stepwell.mechanism.elements.element import Element
from stepwell.mechanism.elements.mobility import MOBILITIES, a_mobility, mobilities_of
from stepwell.mechanism.elements.phase import Phase, Stretch, phase_at
from stepwell.mechanism.elements.sheet import (
    ABOVE,
    BELOW,
    CURVE_HIGH,
    CURVE_LOW,
    FIRST,
    HIGH,
    LOW,
    ROWS,
    ROWS_END,
    SHEET_COLUMNS,
    Sheet,
    before,
)
