"""The wheel and the sdist, built once."""

from pathlib import Path

import pytest

from once import once
from release import trying


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Wheel and sdist of this checkout."""
    folder = once(tmp_path_factory, "dist", trying.build)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, sdist
