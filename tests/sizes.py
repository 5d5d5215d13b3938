"""How large the slow suites are."""

import os
from collections.abc import Iterable
from typing import TypeVar

import pytest

Case = TypeVar("Case")

SIZE = os.environ.get("STEPWELL_TESTS", "ci")
if SIZE not in ("ci", "full"):
    raise pytest.UsageError(f"STEPWELL_TESTS={SIZE!r}: must be 'ci' (the default) or 'full'.")


def examples(n: int, full: int | None = None) -> int:
    """Size of a slow suite: `n` by default; in a full run `full`, or twenty times as many."""
    return n if SIZE == "ci" else full or 20 * n


def cases(every: Iterable[Case], quick: Iterable[Case]) -> list[Case]:
    """Cases of a slow test: all in a full run; by default those that stand for each kind."""
    return list(every if SIZE == "full" else quick)
