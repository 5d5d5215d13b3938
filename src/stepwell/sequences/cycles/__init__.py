"""States, sequences, pathways, and the full cycle of a chain."""

from stepwell.sequences.cycles.cycle import Cycle, arrival, cycle, sequence_of
from stepwell.sequences.cycles.sequence import Pathway, Sequence

from stepwell.sequences.cycles.batch import (  # isort: skip - of single cycles
    IMPOSSIBLE,
    UNSOLVED,
    Cycles,
    cycles_of,
)
