"""What a mechanism is made of: bands, unit cells, loads, chains. Values only, no solving."""

from stepwell.mechanism.band import Band
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.chain import SOFTEST, STIFFEST, Chain
from stepwell.mechanism.curves import Cubic, Law, Linear, Load, Table

__all__ = [
    "SOFTEST",
    "STIFFEST",
    "Band",
    "Cell",
    "Chain",
    "Cubic",
    "Law",
    "Linear",
    "Load",
    "Table",
]
