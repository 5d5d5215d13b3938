"""The verdicts of docs/claims.json, which tests/paper holds against those computed anew."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from stepwell import paper
from stepwell.paper import ClaimVerdict, Judgement, Verdicts

ROOT = Path(__file__).resolve().parents[1]
CLAIMS = ROOT / "docs" / "claims.json"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")
# Texts round to three or four digits; another processor may round the last one otherwise.
ONE_DIGIT = 2e-3


def committed() -> Verdicts:
    """A verdict for each claim, in the order of the claims, without computing any."""
    found = {one["id"]: one for one in json.loads(CLAIMS.read_text("utf-8"))["claims"]}
    claims = paper.claims()
    new = [claim.id for claim in claims if claim.id not in found]
    tool = "python tests/docs/claims_pages.py"
    assert not new, f"{new}: run `{tool} docs/claims.json docs/claims.md`"
    told = [(claim, found[claim.id]) for claim in claims]
    return Verdicts(
        ClaimVerdict(claim, one["ours"], Judgement(one["verdict"]), one["reason"])
        for claim, one in told
    )


def same(a: str, b: str) -> bool:
    """Whether two texts have the same words, and the same numbers but for the last digit."""
    numbers = [[float(n) for n in NUMBER.findall(text)] for text in (a, b)]
    return NUMBER.sub("#", a) == NUMBER.sub("#", b) and numbers[0] == pytest.approx(
        numbers[1], rel=ONE_DIGIT
    )


def assert_committed(file: Path, record: dict[str, Any]) -> None:
    """Fail unless a committed file of claims says what was computed now."""
    found = json.loads(file.read_text("utf-8"))["claims"]
    now = json.loads(json.dumps(record["claims"]))
    assert [claim["id"] for claim in found] == [claim["id"] for claim in now]
    for old, new in zip(found, now, strict=True):
        assert set(old) == set(new)
        for name, text in new.items():
            assert same(old[name], text), (new["id"], name, old[name], text)
