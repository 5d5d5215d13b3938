"""The panels by the names of their files."""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from stepwell.studio.wire import Ask, Design, View


@cache
def types() -> tuple[str, ...]:
    """The type of every panel."""
    return tuple(sorted(_found()))


def is_long(kind: str) -> bool:
    """Whether a panel runs in a process of its own."""
    return bool(getattr(_panel(kind), "LONG", False))


def answer(kind: str, design: Design, ask: Ask) -> View:
    """What a panel answers.

    Raises:
        StepwellError: what the panel refuses; the text says why.
    """
    return _panel(kind).answer(design, ask)


@cache
def _found() -> dict[str, str]:
    """The module of every type; a folder holds panels that ask about the same."""
    here, found = Path(__file__).parent, dict[str, str]()
    for module in pkgutil.walk_packages([str(here)], f"{__package__}."):
        name = module.name.rpartition(".")[2]
        if not module.ispkg and not name.startswith("_"):
            found[name] = module.name
    return found


@cache
def _panel(kind: str) -> ModuleType:
    return import_module(_found()[kind])
