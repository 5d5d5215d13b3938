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
    here = str(Path(__file__).parent)
    names = (module.name for module in pkgutil.iter_modules([here]))
    return tuple(sorted(name for name in names if not name.startswith("_")))


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
def _panel(kind: str) -> ModuleType:
    return import_module(f"{__package__}.{kind}")
