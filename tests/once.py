"""What takes long and is the same for all processes of the tests is made once, by the first."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest


def once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder that is made by the first process that asks for it; the others wait for it.

    Args:
        factory: pytest's own, of any process.
        name: what is in the folder, one word.
        make: fills the folder; where it fails the next that asks tries again.
    """
    from filelock import FileLock

    # Processes of pytest-xdist have folders of their own in one that is the run's.
    base = factory.getbasetemp()
    run = base.parent if base.name.startswith("popen-") else base
    folder, done = run / f"once-{name}", run / f"once-{name}.done"
    with FileLock(run / f"once-{name}.lock"):
        if not done.exists():
            folder.mkdir(exist_ok=True)
            make(folder)
            done.touch()
    return folder
