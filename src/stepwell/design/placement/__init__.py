"""Places for all anchors at once, and how surely they serve."""

from stepwell.design.placement.bent import LOOKS
from stepwell.design.placement.candidates import Candidates, Kind, Rule, differences, joined
from stepwell.design.placement.holes import best_choice, fits
from stepwell.design.placement.outline import all_proved, outlines
from stepwell.design.placement.placement import Placement, Search, choose, measured, shared
from stepwell.design.placement.region import (
    PAPER_BOX,
    PAPER_LEVER,
    AnchorBox,
    AnchorPolygon,
    Region,
    lattice,
    told,
    usual_box,
)
from stepwell.design.placement.stock import PAPER_BAND, Stock
