"""Piecewise cubic curves, of which every law of a cell is made."""

# pyright: reportUnusedImport=false

from stepwell.mechanism.cubics.cubic import (
    COLUMNS,
    cubic,
    cubic_area,
    integral,
    value,
    with_integrals,
)
from stepwell.mechanism.cubics.rows import (
    Force,
    along,
    end_of,
    monotone,
    signs,
    straight,
    through,
)
