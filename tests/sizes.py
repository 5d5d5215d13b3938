"""How large the slow suites are."""

import os

import pytest

SIZE = os.environ.get("STEPWELL_TESTS", "ci")
if SIZE not in ("ci", "full"):
    raise pytest.UsageError(f"STEPWELL_TESTS={SIZE!r}: must be 'ci' (the default) or 'full'.")


def examples(n: int, full: int | None = None) -> int:
    """Size of a slow suite: `n` by default; in a full run `full`, or twenty times as many."""
    return n if SIZE == "ci" else full or 20 * n
