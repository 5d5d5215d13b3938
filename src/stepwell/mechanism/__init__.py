"""What a mechanism is made of: bands, unit cells, loads, chains. Values only, no solving."""

from stepwell.mechanism import curves, sizes
from stepwell.mechanism.band import Band
from stepwell.mechanism.cell import LIMITS_DEG, Cell
from stepwell.mechanism.chain import SOFTEST, STIFFEST, Chain
from stepwell.mechanism.curves import Cubic, Law, Linear, Load, Table
from stepwell.mechanism.law import (
    Floats,
    Ints,
    Laws,
    band_length,
    law,
    length_slopes,
    pick_rows,
    stored,
    summed,
)
from stepwell.mechanism.pack import pack
from stepwell.mechanism.sizes import Size, Slip, SlipError, slips

__all__ = [
    "LIMITS_DEG",
    "SOFTEST",
    "STIFFEST",
    "Band",
    "Cell",
    "Chain",
    "Cubic",
    "Floats",
    "Ints",
    "Law",
    "Laws",
    "Linear",
    "Load",
    "Size",
    "Slip",
    "SlipError",
    "Table",
    "band_length",
    "curves",
    "law",
    "length_slopes",
    "pack",
    "pick_rows",
    "sizes",
    "slips",
    "stored",
    "summed",
]
