"""Claims about unit cells and chains."""

from stepwell.paper.mechanisms.cells import CLAIMS as CELLS
from stepwell.paper.mechanisms.designs import (
    PAIRS,
    monostable_pair,
    outer_anchor,
    pair_cycle,
    six_cells,
)
from stepwell.paper.mechanisms.map import CLAIMS as MAP
from stepwell.paper.mechanisms.measured import IDS, claims as measured_claims
from stepwell.paper.mechanisms.misprints import CLAIMS as MISPRINTS
from stepwell.paper.mechanisms.more_cells import CLAIMS as MORE_CELLS, SPREAD, WANTED
from stepwell.paper.mechanisms.order import CLAIMS as ORDER
from stepwell.paper.mechanisms.pathways import CLAIMS as PATHWAYS
from stepwell.paper.mechanisms.wells import CLAIMS as WELLS
