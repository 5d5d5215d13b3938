"""The closed form of concave cells, where it is proved: certificates, end forces, sorting."""

# pyright: reportUnusedImport=false

from stepwell.concave.cell import (
    Simple,
    energy_at,
    force_at,
    full_travel,
    most_bend,
    of_row,
    simple,
    simple_rows,
    travel_at,
)
from stepwell.concave.certificate import (
    certified,
    certify,
    closed,
    concave_box,
    concave_disc,
    concave_line,
    end_force,
    end_force_field,
    end_forces,
    proved_ends,
    slopes_by_sizes,
    steepest,
)
from stepwell.concave.relays import (
    Relays,
    fewest_strokes,
    garden_states,
    ideals,
    landings,
    levels,
    relays,
    standing_states,
    sub_loops,
    switches,
)
from stepwell.concave.samples import (
    ASK,
    DOES,
    OTHER,
    TIE,
    DrawJudge,
    SampleVerdicts,
    in_disc,
    in_discs,
    sampled_cells,
)
from stepwell.concave.sorting import (
    TIED,
    Neighbour,
    SortedChain,
    motion_orders,
    one_travel,
    proved_cells,
    same_travel,
)
from stepwell.concave.strokes import (
    DECIDED,
    FORCE,
    MOST_CELLS,
    NOT_PROVED,
    STROKE,
    TIES,
    WAKES,
    KeyCounts,
    Way,
    classed,
    closed_graph,
    graph_by_ends,
)
