"""What each extra brings, and what is said about it."""

import tomllib
from pathlib import Path

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
