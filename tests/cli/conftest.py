"""Running the command the way a user does, inside this process."""

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import cache
from importlib import import_module
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from golden.sketching import sketched
from sizes import SIZE
from stepwell.base import installed
from stepwell.cli import about, app
from stepwell.files import preset_text


@pytest.fixture(autouse=True, scope="session")
def drawing_tried_once():
    """By what frames are drawn here is found out by a process, and by one for all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(about, "_opengl", cache(about._opengl))
        yield


@pytest.fixture(autouse=True, scope="module")
def what_takes_seconds_to_open_stays_closed() -> Iterator[None]:
    """In the quick run `stepwell doctor` does not try MuJoCo Warp, which opens for five seconds."""

    def opened(name: str) -> Any:
        return None if SIZE == "ci" and name == "mujoco_warp" else import_module(name)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(installed, "import_module", opened)
        yield


@pytest.fixture(autouse=True, scope="module")
def figures_are_sketched(request: pytest.FixtureRequest) -> Iterator[None]:
    """In the quick run figures are written without being drawn, but for a file that has DRAWN.

    What is drawn tests/figures looks at; commands in processes of their own draw as well.
    """
    drawn = SIZE == "full" or getattr(request.module, "DRAWN", False)
    with nullcontext() if drawn else sketched(words=False):
        yield


@pytest.fixture
def stepwell(tmp_path, monkeypatch) -> Callable[..., Result]:
    """`stepwell(*arguments)` in an empty folder that holds forward.toml."""
    monkeypatch.chdir(tmp_path)
    # A row a line, whatever stands in it; tests/cli/test_width.py looks at narrow screens.
    monkeypatch.setenv("COLUMNS", "1000")
    (tmp_path / "forward.toml").write_text(preset_text("paper-forward"), "utf-8")

    def run(*arguments: object) -> Result:
        return CliRunner().invoke(app, [*map(str, arguments)], prog_name="stepwell")

    return run
