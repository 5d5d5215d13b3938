"""The wheel and the sdist, built once."""

from pathlib import Path

import pytest

from release import trying


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Wheel and sdist of this checkout."""
    return trying.build(tmp_path_factory.mktemp("dist"))
