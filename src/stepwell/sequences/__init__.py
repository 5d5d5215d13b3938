"""What the motion of a chain means: states, sequences, pathways, cycles."""

from stepwell.sequences.cycle import Cycle, cycle
from stepwell.sequences.pathway import Pathway
from stepwell.sequences.sequence import Sequence

__all__ = ["Cycle", "Pathway", "Sequence", "cycle"]
