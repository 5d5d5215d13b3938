"""`stepwell validate`: what others found beside what we compute."""

import json

import pytest

from claims import ROOT
from stepwell import paper
from stepwell.paper import ClaimVerdict
from stepwell.paper.claims import Claim

KNOWN = json.loads((ROOT / "docs" / "others.json").read_text("utf-8"))["claims"]


@pytest.fixture(autouse=True)
def known(monkeypatch):
    """The committed verdicts, in the place of those computed anew."""
    verdicts = {one["id"]: one for one in KNOWN}

    def judge(claim: Claim) -> ClaimVerdict:
        one = verdicts[claim.id]
        return ClaimVerdict(claim, one["ours"], paper.Judgement(one["verdict"]), one["reason"])

    monkeypatch.setattr(Claim, "judge", judge)


def test_every_result_of_others_is_a_line_with_both_values_and_the_verdict(stepwell):
    result = stepwell("validate")
    assert result.exit_code == 0
    lines = result.stdout.partition("Reasons and limits")[0].splitlines()
    for one in KNOWN:
        (line,) = (line for line in lines if line.startswith(f"{one['id']} "))
        assert f"  {one['where']}  " in line and f"  {one['ours']}  " in line
        assert line.endswith(f"  {one['verdict']}")
    assert f"{len(KNOWN)} of {len(KNOWN)} claims agree" in result.stdout


def test_json_is_that_of_the_paper(stepwell):
    record = json.loads(stepwell("validate", "--json").stdout)
    assert record["schema"] == "stepwell.paper/1"
    assert record["claims"] == KNOWN
