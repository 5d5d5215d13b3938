"""The verdicts of docs/claims.json, which tests/paper holds against those computed anew."""

import json
from pathlib import Path

from stepwell import paper
from stepwell.paper import Judgement, Verdict

ROOT = Path(__file__).resolve().parents[1]
CLAIMS = ROOT / "docs" / "claims.json"


def committed() -> tuple[Verdict, ...]:
    """A verdict for each claim, in the order of the claims, without computing any."""
    found = {one["id"]: one for one in json.loads(CLAIMS.read_text("utf-8"))["claims"]}
    told = [(claim, found[claim.id]) for claim in paper.claims()]
    return tuple(
        Verdict(claim, one["ours"], Judgement(one["verdict"]), one["reason"]) for claim, one in told
    )
