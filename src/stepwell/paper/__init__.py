"""The claims of the paper as data, each with a function that computes ours."""

from stepwell.paper.claims import Claim, Finding, Judgement, Verdict, markdown
from stepwell.paper.run import claims, outputs, record, run

__all__ = [
    "Claim",
    "Finding",
    "Judgement",
    "Verdict",
    "claims",
    "markdown",
    "outputs",
    "record",
    "run",
]
