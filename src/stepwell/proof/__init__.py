"""Proofs of paths in ball arithmetic: every event enclosed, every stretch between two covered.

Terms: a *ball* is an interval with middle and radius; a *stretch* is the motion between two events;
a *gap* is a part of a path that is not proved. The extra `proof` brings python-flint.
"""

from typing import TYPE_CHECKING

from stepwell.base import late

if TYPE_CHECKING:
    from stepwell.proof.path_proof import Gap, PathProof, ProvedEvent, Theorem, prove
    from stepwell.proof.proved_run import ProvedRun

__all__ = ["Gap", "PathProof", "ProvedEvent", "ProvedRun", "Theorem", "prove"]

_LATE = {
    "path_proof": ("Gap", "PathProof", "ProvedEvent", "Theorem", "prove"),
    "proved_run": ("ProvedRun",),
}

__getattr__, __dir__ = late(__name__, _LATE, __all__)
