"""The committed verdicts, for the tests that ask what is done with them."""

import pytest

from claims import committed
from stepwell.paper.claims import Claim, ClaimVerdict


@pytest.fixture(scope="session")
def verdicts() -> tuple[ClaimVerdict, ...]:
    """What docs/claims.json says; `test_claims_file` holds it against what is computed."""
    return committed()


@pytest.fixture
def known_verdicts(verdicts, monkeypatch) -> None:
    """Judging gives what is committed: for tests of what is done with it."""
    known = {verdict.claim.id: verdict for verdict in verdicts}
    monkeypatch.setattr(Claim, "judge", lambda claim: known[claim.id])
