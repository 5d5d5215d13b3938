"""Proofs of paths in ball arithmetic: every event enclosed, every stretch between two covered.

Terms: a *ball* is an interval with middle and radius; a *stretch* is the motion between two events;
a *gap* is a part of a path that is not proved. The extra `proof` brings python-flint.
"""

from typing import TYPE_CHECKING

from stepwell.base import late

if TYPE_CHECKING:
    from stepwell.proof.box_proofs import (
        BoxOutcome,
        MarginProof,
        ProvedChange,
        ProvedDesign,
        ProvedImpossible,
        ToleranceProof,
    )
    from stepwell.proof.box_prover import prove_design, prove_margin, prove_tolerances
    from stepwell.proof.certificates import certificate
    from stepwell.proof.exclusions import prove_impossible
    from stepwell.proof.path_proof import PathProof, ProofGap, ProvedEvent, ProvedRun, Theorem
    from stepwell.proof.prover import prove
    from stepwell.proof.ranges import (
        CriticalRange,
        critical_ranges,
        falling,
        force_range,
        sorted_as,
    )

__all__ = [
    "BoxOutcome",
    "CriticalRange",
    "MarginProof",
    "PathProof",
    "ProofGap",
    "ProvedChange",
    "ProvedDesign",
    "ProvedEvent",
    "ProvedImpossible",
    "ProvedRun",
    "Theorem",
    "ToleranceProof",
    "certificate",
    "critical_ranges",
    "falling",
    "force_range",
    "prove",
    "prove_design",
    "prove_impossible",
    "prove_margin",
    "prove_tolerances",
    "sorted_as",
]

_LATE = {
    "box_proofs": (
        *("BoxOutcome", "MarginProof", "ProvedChange", "ProvedDesign", "ProvedImpossible"),
        "ToleranceProof",
    ),
    "box_prover": ("prove_design", "prove_margin", "prove_tolerances"),
    "certificates": ("certificate",),
    "exclusions": ("prove_impossible",),
    "path_proof": ("PathProof", "ProofGap", "ProvedEvent", "ProvedRun", "Theorem"),
    "prover": ("prove",),
    "ranges": ("CriticalRange", "critical_ranges", "falling", "force_range", "sorted_as"),
}

__getattr__, __dir__ = late(__name__, _LATE, __all__)
