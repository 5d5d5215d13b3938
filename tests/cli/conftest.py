"""Running the command the way a user does, inside this process."""

from collections.abc import Callable

import pytest
from typer.testing import CliRunner, Result

from stepwell.cli import app
from stepwell.files import preset_text


@pytest.fixture
def stepwell(tmp_path, monkeypatch) -> Callable[..., Result]:
    """`stepwell(*arguments)` in an empty folder that holds forward.toml."""
    monkeypatch.chdir(tmp_path)
    # A row a line, whatever stands in it; tests/cli/test_width.py looks at narrow screens.
    monkeypatch.setenv("COLUMNS", "1000")
    (tmp_path / "forward.toml").write_text(preset_text("paper-forward"), "utf-8")
    return lambda *arguments: CliRunner().invoke(app, [*map(str, arguments)], prog_name="stepwell")
