"""A run of a design with the proof of its cycle."""

from dataclasses import dataclass, field

from stepwell.design import Run
from stepwell.proof.path_proof import PathProof


@dataclass(frozen=True, eq=False)
class ProvedRun(Run):
    """A full cycle of a design with its margin, and what is proved of the cycle.

    Attributes:
        proof: the proof of the cycle's path.
    """

    proof: PathProof = field(repr=False)

    @classmethod
    def proved(cls, run: Run, proof: PathProof) -> "ProvedRun":
        """A run with the proof of its path."""
        return cls(run.cycle, run.margin, run.landings, proof)
