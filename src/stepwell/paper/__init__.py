"""Claims of the paper and of others as data, each with a function that computes our value."""

from stepwell.paper.cells import PAIRS, monostable_pair, outer_anchor, pair_cycle, six_cells
from stepwell.paper.claims import Claim, ClaimVerdict, Finding, Judgement, Verdicts, markdown
from stepwell.paper.proofs import ClaimProof, claim_proofs
from stepwell.paper.ranges import AssumedRange, AssumedRanges, assumed_ranges
from stepwell.paper.run import claims, others, run, validate
from stepwell.paper.sensitivity import Effect, Sensitivity, sensitivities
from stepwell.paper.walking import robot, walk_of

__all__ = [
    "AssumedRange",
    "AssumedRanges",
    "Claim",
    "ClaimProof",
    "Effect",
    "Finding",
    "Judgement",
    "Sensitivity",
    "ClaimVerdict",
    "Verdicts",
    "assumed_ranges",
    "claim_proofs",
    "claims",
    "markdown",
    "others",
    "run",
    "validate",
]
