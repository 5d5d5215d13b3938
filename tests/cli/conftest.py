"""Running the command the way a user does, inside this process."""

from collections.abc import Callable
from functools import cache

import pytest
from typer.testing import CliRunner, Result

from stepwell.cli import about, app
from stepwell.files import preset_text


@pytest.fixture(autouse=True, scope="session")
def drawing_tried_once():
    """By what frames are drawn here is found out by a process, and by one for all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(about, "_opengl", cache(about._opengl))
        yield


@pytest.fixture
def stepwell(tmp_path, monkeypatch) -> Callable[..., Result]:
    """`stepwell(*arguments)` in an empty folder that holds forward.toml."""
    monkeypatch.chdir(tmp_path)
    # A row a line, whatever stands in it; tests/cli/test_width.py looks at narrow screens.
    monkeypatch.setenv("COLUMNS", "1000")
    (tmp_path / "forward.toml").write_text(preset_text("paper-forward"), "utf-8")
    return lambda *arguments: CliRunner().invoke(app, [*map(str, arguments)], prog_name="stepwell")
