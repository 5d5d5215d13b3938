"""Proofs of paths in ball arithmetic: every event enclosed, every stretch between two covered.

Terms: a *ball* is an interval with middle and radius; a *stretch* is the motion between two events;
a *gap* is a part of a path that is not proved. The extra `proof` brings python-flint.
"""

from typing import TYPE_CHECKING

from stepwell.base import late

if TYPE_CHECKING:
    from stepwell.proof.certificates import certificate
    from stepwell.proof.path_proof import PathProof, ProofGap, ProvedEvent, ProvedRun, Theorem
    from stepwell.proof.prover import prove

__all__ = ["certificate", "PathProof", "ProofGap", "ProvedEvent", "ProvedRun", "Theorem", "prove"]

_LATE = {
    "certificates": ("certificate",),
    "path_proof": ("PathProof", "ProofGap", "ProvedEvent", "ProvedRun", "Theorem"),
    "prover": ("prove",),
}

__getattr__, __dir__ = late(__name__, _LATE, __all__)
