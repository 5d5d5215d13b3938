"""A claim, and the table of verdicts."""

from stepwell.paper.claims.claim import Claim, Finding, Judgement, Verdict, claim, judged
from stepwell.paper.claims.table import markdown, replaced
