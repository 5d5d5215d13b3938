"""What a mechanism is made of: bands, unit cells, loads, chains. Values only, no solving."""

# pyright: reportUnusedImport=false

from stepwell.mechanism import elements, geometry, layout, levers, sizes
from stepwell.mechanism.band import Band, Cubic, Law, Linear, Load, Table, hooke
from stepwell.mechanism.cell import LIMITS_DEG, Cell
from stepwell.mechanism.chain import SOFTEST, STIFFEST, Chain
from stepwell.mechanism.cubics import through, value
from stepwell.mechanism.element import Element
from stepwell.mechanism.elements import (
    LIBRARY,
    LibraryEntry,
    balloon,
    curved_beam,
    dome,
    kresling,
    trilinear,
    von_mises_truss,
)
from stepwell.mechanism.law import (
    BEFORE,
    BEYOND,
    Laws,
    Looks,
    Sheets,
    beyond,
    change_sheet,
    ends_of,
    largest,
    law,
    law_along,
    packed,
    pick_rows,
    smallest,
    stored,
    summed,
)
from stepwell.mechanism.phase import (
    ABOVE,
    BELOW,
    CURVE_HIGH,
    CURVE_LOW,
    FIRST,
    HIGH,
    LOW,
    MOBILITIES,
    Phase,
    Sheet,
    Stretch,
    mobilities_of,
    phase_at,
)
from stepwell.mechanism.scatter import scatter_of_curve
from stepwell.mechanism.sizes import Size, Slip, SlipError, slips
from stepwell.mechanism.smoothing import Fit, fitted

__all__ = [
    "LIBRARY",
    "LIMITS_DEG",
    "SOFTEST",
    "STIFFEST",
    "Band",
    "Cell",
    "Chain",
    "Cubic",
    "Element",
    "Law",
    "LibraryEntry",
    "Linear",
    "Load",
    "Phase",
    "Sheet",
    "Slip",
    "SlipError",
    "Table",
    "balloon",
    "curved_beam",
    "dome",
    "kresling",
    "slips",
    "trilinear",
    "von_mises_truss",
]
