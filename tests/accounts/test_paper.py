"""The account of verdicts: each claim once, the same in every form."""

from accounts.schemas import violations
from claims import committed
from stepwell.accounts import account, card, page, terminal
from stepwell.accounts.rendering.terminal import SCREEN


def test_the_record_of_verdicts_keeps_to_the_schema_and_every_form_has_the_count():
    verdicts = committed()
    found = account(verdicts)
    assert violations(found.record) == []
    assert len(found.record["claims"]) == len(verdicts)
    agreed = sum(one["verdict"] == "agrees" for one in found.record["claims"])
    text = "\n".join(line.text for line in terminal(found, full=True))
    for form in (text, card(found), page(found)):
        assert f"{agreed} of {len(verdicts)} claims agree" in form


def test_verdicts_fit_a_screen_and_their_count_is_the_first_line():
    verdicts = committed()
    lines = [line.text for line in terminal(account(verdicts))]
    assert len(lines) <= SCREEN
    assert lines[0].endswith(f"of {len(verdicts)} claims agree")


def test_a_page_has_every_statement_and_every_reason():
    verdicts = committed()
    made = page(account(verdicts))
    reasons = [one.claim.id for one in verdicts if one.reason]
    assert made.count("<td") == 7 * len(verdicts) + 2 * len(reasons)
