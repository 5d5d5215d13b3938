"""How hard the tests try: quickly by default, thoroughly with STEPWELL_TESTS=full."""

import os

import pytest
from hypothesis import settings

SIZE = os.environ.get("STEPWELL_TESTS", "ci")
if SIZE not in ("ci", "full"):
    raise pytest.UsageError(f"STEPWELL_TESTS={SIZE!r}: must be 'ci' (the default) or 'full'.")

# No deadlines: the first call of a compiled kernel takes seconds, and no test asserts a time.
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True, max_examples=50)
settings.register_profile("full", deadline=None, print_blob=True, max_examples=1000)
settings.load_profile(SIZE)


def examples(n: int) -> int:
    """Size of a slow suite: `n` in the default run, twenty times as many in a full one."""
    return n if SIZE == "ci" else 20 * n
