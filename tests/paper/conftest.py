"""The claims judged once for the files of this room that ask what comes out."""

import pytest

from stepwell import paper
from stepwell.paper.claims.claim import Claim, Verdict


@pytest.fixture(scope="session")
def computed() -> tuple[Verdict, ...]:
    return paper.run()


@pytest.fixture
def known_verdicts(computed, monkeypatch):
    """Judging gives what is computed already: for tests of what is done with it."""
    verdicts = {verdict.claim.id: verdict for verdict in computed}
    monkeypatch.setattr(Claim, "judge", lambda claim: verdicts[claim.id])
