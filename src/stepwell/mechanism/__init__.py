"""What a mechanism is made of: bands, unit cells, loads, chains. Values only, no solving."""

from stepwell.mechanism.band import Band
from stepwell.mechanism.cell import LIMITS_DEG, Cell
from stepwell.mechanism.chain import SOFTEST, STIFFEST, Chain
from stepwell.mechanism.curves import Cubic, Law, Linear, Load, Table
from stepwell.mechanism.sizes import Slip, SlipError, slips

__all__ = [
    "LIMITS_DEG",
    "SOFTEST",
    "STIFFEST",
    "Band",
    "Cell",
    "Chain",
    "Cubic",
    "Law",
    "Linear",
    "Load",
    "Slip",
    "SlipError",
    "Table",
    "slips",
]
