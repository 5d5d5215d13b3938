"""The atlas: every machine that a space of designs holds, its share, and its most robust design."""

from stepwell.atlas.atlas import Atlas, Cycling, Machine, Sampled, atlas, blocks
from stepwell.atlas.borders import Border, borders
from stepwell.atlas.canonical import canonical, name_of
from stepwell.atlas.charted import charted
from stepwell.atlas.find import QUERIES, THREE, find, understood
from stepwell.atlas.proofs import possible, proved_space

__all__ = [
    "Atlas",
    "Border",
    "Cycling",
    "Machine",
    "QUERIES",
    "Sampled",
    "THREE",
    "atlas",
    "blocks",
    "borders",
    "canonical",
    "charted",
    "find",
    "name_of",
    "possible",
    "proved_space",
    "understood",
]
