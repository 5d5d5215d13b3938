"""Elements of the field, each a function that makes one: springs, trusses, beams, folds, rubber."""

# pyright: reportUnusedImport=false

from stepwell.mechanism.library.balloon import balloon
from stepwell.mechanism.library.curved_beam import curved_beam
from stepwell.mechanism.library.dome import dome
from stepwell.mechanism.library.entries import LIBRARY, Entry
from stepwell.mechanism.library.kresling import kresling
from stepwell.mechanism.library.trilinear import trilinear
from stepwell.mechanism.library.von_mises_truss import von_mises_truss

__all__ = [
    "LIBRARY",
    "Entry",
    "balloon",
    "curved_beam",
    "dome",
    "kresling",
    "trilinear",
    "von_mises_truss",
]
