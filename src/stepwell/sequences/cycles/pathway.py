"""The four ways in which two cells can go round."""

from enum import Enum

from stepwell.sequences.cycles.sequence import Sequence


class Pathway(Enum):
    """How a two-cell chain loads and unloads (Kamp et al. 2024, Fig. 2)."""

    CLOCKWISE = "00>10>11>01>00"
    COUNTERCLOCKWISE = "00>01>11>10>00"
    VIA_01 = "00>01>11>01>00"
    VIA_10 = "00>10>11>10>00"
    OTHER = "any other sequence"

    @property
    def label(self) -> str:
        """A word or two for tables and figures."""
        return {"VIA_01": "via 01", "VIA_10": "via 10"}.get(self.name, self.name.lower())

    @property
    def is_directed(self) -> bool:
        """Whether loading and unloading take different ways."""
        return self in (Pathway.CLOCKWISE, Pathway.COUNTERCLOCKWISE)


def pathway_of(sequence: Sequence) -> Pathway | None:
    """The pathway of a full cycle of two cells; None for any other number of cells."""
    if len(sequence.first) != 2:
        return None
    text = str(sequence)
    return next((p for p in Pathway if p.value == text), Pathway.OTHER)
