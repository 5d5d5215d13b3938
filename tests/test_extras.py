"""What each extra brings, and what is said about it."""

import re
import tomllib
from pathlib import Path

from stepwell.base import SOURCE

ROOT = Path(__file__).resolve().parents[1]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
    "optional-dependencies"
]


def test_simulating_a_robot_brings_no_encoder():
    assert [name.partition(">")[0] for name in EXTRAS["robot"]] == ["mujoco"]
    assert [name.partition(">")[0] for name in EXTRAS["video"]] == ["av"]
    assert "stepwell[all,docs]" in EXTRAS["dev"]


def test_the_pages_say_what_the_encoder_is_and_whose_licence_it_has():
    for page in ("commands/index.md", "how-to/robots.md", "decisions/video-apart.md"):
        text = (ROOT / "docs" / page).read_text("utf-8")
        assert "libx264" in text and "GPL" in text and "video]'" in text, page


def test_the_first_page_says_which_systems_are_tested():
    text = (ROOT / "README.md").read_text("utf-8")
    assert "macOS or Windows" in text and "not been tested" in text


def test_every_page_installs_from_the_source_that_the_messages_name():
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")]
    installs = re.compile(r"pip install (?:--[\w-]+ )*'?(\.|stepwell)(?![\w-])(?:\[([\w,]+)\])?")
    found = [(page, *one) for page in pages for one in installs.findall(page.read_text("utf-8"))]
    assert len(found) > 10
    assert [page for page, source, _ in found if source != SOURCE] == []
    assert {extra for *_, extras in found for extra in extras.split(",") if extra} <= EXTRAS.keys()


def test_one_line_of_the_sources_names_where_pip_finds_stepwell():
    own = re.compile(r"pip install[^\n]*\bstepwell\b|pip install '?\.|stepwell\[")
    sources = (ROOT / "src" / "stepwell").rglob("*.py")
    assert [file for file in sources if own.search(file.read_text("utf-8"))] == []
