"""How hard the tests try: quickly by default, thoroughly with STEPWELL_TESTS=full.

And what those of several rooms share: recordings, a browser, the sources of the studio's page.
"""

from __future__ import annotations

import gc
import hashlib
import os
import pickle
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

from once import once
from sizes import SIZE

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from stepwell.base import Progress
    from stepwell.build import MotionSweep, RobotLayout

ROOT = Path(__file__).resolve().parents[1]

# No deadlines: the first call of a compiled kernel takes seconds, and no test asserts a time.
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True, max_examples=20)
settings.register_profile("full", deadline=None, print_blob=True, max_examples=1000)
settings.load_profile(SIZE)


def pytest_configure(config: pytest.Config) -> None:
    # For the processes that run the tests: where several do, threads of the linear algebra wait for
    # each other, and small fits take ten times as long. NumPy reads this as it is imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Files go to the cores in the order of collection, not the one with most tests first.
    config.option.loadscopereorder = False
    # While tests are collected hardly anything is thrown away, and looking for it takes as long.
    gc.set_threshold(100_000, 100, 100)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """More than the cores for all tests, one for a few that are named, unless `-n` is said.

    Tests wait for browsers and for other processes a third of their time.
    """
    said = any(one.startswith(("-n", "--numprocesses")) for one in config.invocation_params.args)
    named = config.args_source is not pytest.Config.ArgsSource.TESTPATHS
    if said:
        return None
    return 0 if named else (os.cpu_count() or 1) + 1


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with much that is slow come first, so that no core has one of them left at the end.

    All that is looked at in a browser is slow.
    """
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker("slow")
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: -slow[item.path])


def pytest_collection_finish() -> None:
    """Python looks less often for what can be freed, and not among what stays.

    Half a million objects stay; to look through them was a sixth of the time of quick tests.
    """
    gc.freeze()
    gc.set_threshold(10_000, 10, 10)


@pytest.fixture(autouse=True, scope="session")
def predicted_once():
    """A robot that several tests of a process ask about is predicted once."""
    from stepwell.robot import Robot

    with pytest.MonkeyPatch.context() as patch:
        # A prediction is a value that depends on the robot's value alone.
        patch.setattr(Robot, "predict", cache(Robot.predict))
        yield


@pytest.fixture(autouse=True, scope="session")
def swept_once(tmp_path_factory: pytest.TempPathFactory):
    """The parts of a robot that several tests build are swept once, by the first process."""
    from stepwell.build.robots import robot_builds

    sweep = robot_builds.robot_sweep

    def shared(layout: RobotLayout, progress: Progress = None) -> MotionSweep:
        # A sweep is a value that depends on the robot's and the build file's values alone.
        asked = pickle.dumps((layout.robot, layout.build_file))
        name = f"sweep-{hashlib.sha256(asked).hexdigest()[:16]}"

        def make(folder: Path) -> None:
            (folder / "sweep.pickle").write_bytes(pickle.dumps(sweep(layout, progress)))

        return pickle.loads((once(tmp_path_factory, name, make) / "sweep.pickle").read_bytes())

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(robot_builds, "robot_sweep", shared)
        yield


@pytest.fixture(scope="session")
def graphics(tmp_path_factory: pytest.TempPathFactory) -> str | None:
    """By what frames are drawn off screen here; None where they cannot be.

    Of all processes: each try starts MuJoCo in a process of its own.
    """
    from stepwell.simulation import drawing_system

    def tried(folder: Path) -> None:
        (folder / "system").write_text(drawing_system() or "", "utf-8")

    folder = once(tmp_path_factory, "graphics", tried)
    return (folder / "system").read_text("utf-8") or None


@pytest.fixture(scope="session")
def drawable(graphics: str | None) -> None:
    """For tests of frames that are drawn off screen."""
    if graphics is None:
        pytest.skip("frames cannot be drawn off screen here")


@pytest.fixture(autouse=True, scope="session")
def put_together_once():
    """The commands are put together once a process, which takes as long as many of them run."""
    import typer.testing

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(typer.testing, "_get_command", cache(typer.main.get_command))
        yield


@pytest.fixture(scope="session")
def kamp2024() -> Path:
    """The authors' recordings, which are not part of the repository.

    They are looked for where STEPWELL_RECORDINGS says, else in a folder `shared` beside the
    repository.
    """
    told = os.environ.get("STEPWELL_RECORDINGS")
    folder = Path(told) if told else ROOT.parent / "shared" / "data" / "kamp2024"
    if told and not folder.is_dir():
        raise pytest.UsageError(f"STEPWELL_RECORDINGS={told!r}: no such folder.")
    if not folder.is_dir():
        pytest.skip("SKIPPED, the authors' recordings are not here: set STEPWELL_RECORDINGS")
    return folder


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page's sources in a folder of their own, with what builds and tests them.

    Of all processes: nothing may be written there.
    """
    npm = shutil.which("npm")
    if npm is None and os.environ.get("STEPWELL_REQUIRE_BROWSER") != "1":
        pytest.skip("npm is not installed: the studio's page is not built anew, nor run by axe")
    assert npm is not None, "STEPWELL_REQUIRE_BROWSER=1, and npm is not installed"
    words = [npm, "ci", "--no-audit", "--no-fund", "--ignore-scripts"]

    def installed(folder: Path) -> None:
        found = folder / "studio"
        ignored = shutil.ignore_patterns("node_modules")
        shutil.copytree(ROOT / "studio", found, ignore=ignored, dirs_exist_ok=True)
        done = subprocess.run(words, cwd=found, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr

    return once(tmp_path_factory, "sources", installed) / "studio"


@pytest.fixture(scope="session")
def axe(request: pytest.FixtureRequest) -> str:
    """The script that looks for what keeps people out: what is installed here, or comes now."""
    inside = Path("node_modules", "axe-core", "axe.min.js")
    here = ROOT / "studio" / inside
    found = here if here.exists() else request.getfixturevalue("sources") / inside
    return found.read_text()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    from chromium import CHROMIUM, QUIET, needed

    needed()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        yield browser
        browser.close()
