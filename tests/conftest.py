"""How hard the tests try: quickly by default, thoroughly with STEPWELL_TESTS=full."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

from sizes import SIZE

# No deadlines: the first call of a compiled kernel takes seconds, and no test asserts a time.
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True, max_examples=50)
settings.register_profile("full", deadline=None, print_blob=True, max_examples=1000)
settings.load_profile(SIZE)


@pytest.fixture(scope="session")
def kamp2024() -> Path:
    """The authors' recordings, which are not part of the repository.

    They are looked for where STEPWELL_RECORDINGS says, else in a folder `shared` beside the
    repository.
    """
    told = os.environ.get("STEPWELL_RECORDINGS")
    root = Path(__file__).resolve().parents[1]
    folder = Path(told) if told else root.parent / "shared" / "data" / "kamp2024"
    if told and not folder.is_dir():
        raise pytest.UsageError(f"STEPWELL_RECORDINGS={told!r}: no such folder.")
    if not folder.is_dir():
        pytest.skip("SKIPPED, the authors' recordings are not here: set STEPWELL_RECORDINGS")
    return folder
