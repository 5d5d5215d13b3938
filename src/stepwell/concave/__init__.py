"""The closed form of concave cells, where it is proved: certificates, end forces, sorting."""

from stepwell.concave.cell import (
    Simple,
    energy_at,
    force_at,
    most_bend,
    of_row,
    simple,
    simple_rows,
    travel_at,
)
from stepwell.concave.certificate import (
    certified,
    certified_within,
    certify,
    closed,
    concave_disc,
    concave_line,
)
from stepwell.concave.ends import (
    end_force,
    end_force_field,
    end_forces,
    end_forces_at,
    proved_ends,
    slopes_by_sizes,
)
from stepwell.concave.nearest import nearest_of, sift
from stepwell.concave.pair import decide, sweep
from stepwell.concave.relays import Plan, Relays, fewest_strokes, relays
from stepwell.concave.samples import ASK, DOES, OTHER, TIE, Judge, in_disc
from stepwell.concave.sorting import (
    TIED,
    SortedChain,
    motion_orders,
    one_travel,
    proved_cells,
    same_travel,
    smallest_gap,
    snaps_of,
)

__all__ = [
    "ASK",
    "DOES",
    "OTHER",
    "TIE",
    "TIED",
    "Judge",
    "Plan",
    "Relays",
    "Simple",
    "SortedChain",
    "certified",
    "certified_within",
    "certify",
    "closed",
    "concave_disc",
    "concave_line",
    "decide",
    "end_force",
    "end_force_field",
    "end_forces",
    "end_forces_at",
    "energy_at",
    "fewest_strokes",
    "force_at",
    "in_disc",
    "most_bend",
    "nearest_of",
    "of_row",
    "one_travel",
    "motion_orders",
    "proved_cells",
    "proved_ends",
    "relays",
    "same_travel",
    "sift",
    "simple",
    "simple_rows",
    "slopes_by_sizes",
    "smallest_gap",
    "snaps_of",
    "sweep",
    "travel_at",
]
