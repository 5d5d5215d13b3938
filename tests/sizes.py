"""How large the slow suites are."""

import os

import pytest

SIZE = os.environ.get("STEPWELL_TESTS", "ci")
if SIZE not in ("ci", "full"):
    raise pytest.UsageError(f"STEPWELL_TESTS={SIZE!r}: must be 'ci' (the default) or 'full'.")


def examples(n: int) -> int:
    """Size of a slow suite: `n` in the default run, twenty times as many in a full one."""
    return n if SIZE == "ci" else 20 * n
