"""Claims of the paper and of others as data, each with a function that computes ours."""

from stepwell.paper.claims import Claim, Finding, Judgement, Verdict, markdown
from stepwell.paper.run import claims, figure_of, others, outputs, record, run, validate

__all__ = [
    "Claim",
    "Finding",
    "Judgement",
    "Verdict",
    "claims",
    "markdown",
    "others",
    "figure_of",
    "outputs",
    "record",
    "run",
    "validate",
]
