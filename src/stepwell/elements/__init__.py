"""Elements of the field, each a function that makes one: springs, trusses, beams, folds, rubber."""

# pyright: reportUnusedImport=false

from stepwell.elements.balloon import balloon
from stepwell.elements.curved_beam import curved_beam
from stepwell.elements.dome import dome
from stepwell.elements.entries import LIBRARY, LibraryEntry
from stepwell.elements.kresling import kresling
from stepwell.elements.trilinear import trilinear
from stepwell.elements.von_mises_truss import von_mises_truss

__all__ = [
    "LIBRARY",
    "LibraryEntry",
    "balloon",
    "curved_beam",
    "dome",
    "kresling",
    "trilinear",
    "von_mises_truss",
]
