"""The committed results of others say what the model computes today; all computed once, here."""

import pytest

from claims import ROOT, assert_committed, same
from facts import says
from stepwell import paper
from stepwell.accounts import account
from stepwell.paper import Judgement, Verdicts
from stepwell.paper.claims import replaced

FILE, PAGE = ROOT / "docs" / "others.json", ROOT / "docs" / "others.md"


@pytest.fixture(scope="module")
def computed() -> dict[str, paper.ClaimVerdict]:
    """Every claim of others judged anew."""
    return {verdict.claim.id: verdict for verdict in paper.validate()}


@pytest.mark.slow
@pytest.mark.shown
def test_the_committed_results_of_others_are_those_computed_now(computed):
    assert_committed(FILE, account(Verdicts(computed.values())).record)


@pytest.mark.slow
@pytest.mark.shown
def test_the_page_of_others_shows_what_is_computed_now(computed):
    text = PAGE.read_text("utf-8")
    assert same(text, replaced(text, paper.markdown(computed.values())))


@pytest.mark.slow
@pytest.mark.parametrize("claim", paper.others(), ids=lambda claim: claim.id)
def test_a_result_of_others_agrees(claim, computed):
    assert computed[claim.id].verdict is Judgement.AGREES


@pytest.mark.slow
def test_what_decides_between_the_graphs_of_pairs_is_said(computed):
    verdict = computed["pairs-that-fold"]
    assert verdict.ours == "18 of 35, 13 of 13"
    says(verdict.reason, "6 of", "35", "impossible")
    says(verdict.reason, "11", "undecided")


def test_every_result_of_others_names_its_source_and_has_a_short_name_of_its_own():
    names = [claim.id for claim in paper.others()]
    assert len(set(names)) == len(names)
    assert not set(names) & {claim.id for claim in paper.claims(everything=True)}
    # A year stands in every source.
    assert all(any(year in claim.where for year in ("20", "ours")) for claim in paper.others())


def test_progress_is_reported_claim_by_claim(monkeypatch):
    monkeypatch.setattr(paper.Claim, "judge", lambda claim: claim.id)
    reported: list[tuple[int, int]] = []
    verdicts = paper.validate(lambda *step: reported.append(step))
    count = len(paper.others())
    assert len(verdicts) == count
    assert reported == [(k + 1, count) for k in range(count)]
