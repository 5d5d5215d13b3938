"""The designs that come with the package: the paper's, some that go further, robots."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files

from stepwell.files.text import DesignError, did_you_mean


def presets() -> dict[str, str]:
    """The name of every design that comes with the package, and its title."""
    return {name: tomllib.loads(text)["title"] for name, text in _texts().items()}


def preset_text(name: str) -> str:
    """The design file of that name, TOML with its comments, to be saved and edited.

    Args:
        name: as `presets` lists it.

    Raises:
        DesignError: there is none of that name; the text says which is nearest.
    """
    texts = _texts()
    if name not in texts:
        raise DesignError(f"preset {name}", [f"no such design. {did_you_mean(name, texts)}"])
    return texts[name]


@cache
def _texts() -> dict[str, str]:
    folder = files("stepwell.files") / "presets"
    found = (file for file in folder.iterdir() if file.name.endswith(".toml"))
    texts = {file.name.removesuffix(".toml"): file.read_text("utf-8") for file in found}
    # The paper's first, as a reader of the paper looks for them; robots last.
    order = sorted(texts, key=lambda name: (_turn(name), name))
    return {name: texts[name] for name in order}


def _turn(name: str) -> int:
    return 0 if name.startswith("paper-") else 2 if name.startswith("robot-") else 1
