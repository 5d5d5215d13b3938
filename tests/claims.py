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
    claims = paper.claims()
    new = [claim.id for claim in claims if claim.id not in found]
    assert not new, f"{new}: run `python -m stepwell.paper docs/claims.json docs/claims.md`"
    told = [(claim, found[claim.id]) for claim in claims]
    return tuple(
        Verdict(claim, one["ours"], Judgement(one["verdict"]), one["reason"]) for claim, one in told
    )
