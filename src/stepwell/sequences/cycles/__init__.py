"""States, sequences, pathways, and the full cycle of a chain."""

from stepwell.sequences.cycles.cycle import Cycle, cycle
from stepwell.sequences.cycles.pathway import Pathway
from stepwell.sequences.cycles.sequence import Sequence
from stepwell.sequences.cycles.vertices import arrival, sequence_of
