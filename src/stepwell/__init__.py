"""Design, check and understand machines whose motion is programmed into their springs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.base import __version__

if TYPE_CHECKING:
    from stepwell.base import InputError, StepwellError
    from stepwell.design import Margin, Tolerances, Yield, design, margin, transition_map
    from stepwell.files import load, preset, presets, save
    from stepwell.mechanism import Band, Cell, Chain, Cubic, Linear, Load, Table
    from stepwell.robot import Arena, Robot
    from stepwell.sequences import (
        Cycle,
        Pathway,
        Program,
        Sequence,
        TransitionGraph,
        Unreachable,
    )
    from stepwell.statics import Event, EventKind, Path

# Rooms open when a name is first asked for: `import stepwell` costs nothing.
_DOORS = {
    "Arena": "robot",
    "InputError": "base",
    "StepwellError": "base",
    "Band": "mechanism",
    "Cell": "mechanism",
    "Chain": "mechanism",
    "Cubic": "mechanism",
    "Cycle": "sequences",
    "Event": "statics",
    "EventKind": "statics",
    "Linear": "mechanism",
    "Load": "mechanism",
    "Margin": "design",
    "Path": "statics",
    "Pathway": "sequences",
    "Program": "sequences",
    "Robot": "robot",
    "Sequence": "sequences",
    "Tolerances": "design",
    "Table": "mechanism",
    "TransitionGraph": "sequences",
    "Unreachable": "sequences",
    "Yield": "design",
    "load": "files",
    "margin": "design",
    "preset": "files",
    "presets": "files",
    "save": "files",
    "transition_map": "design",
}

__all__ = [
    "Arena",
    "Band",
    "Cell",
    "Chain",
    "Cubic",
    "Cycle",
    "Event",
    "EventKind",
    "InputError",
    "Linear",
    "Load",
    "Margin",
    "Path",
    "Pathway",
    "Program",
    "Robot",
    "Sequence",
    "StepwellError",
    "Table",
    "Tolerances",
    "TransitionGraph",
    "Unreachable",
    "Yield",
    "__version__",
    "design",
    "load",
    "margin",
    "preset",
    "presets",
    "save",
    "transition_map",
]


def __getattr__(name: str) -> Any:
    if name == "design":
        # The room itself, which can be called: once it is open, Python puts it under this name.
        return import_module("stepwell.design")
    if name in _DOORS:
        return getattr(import_module(f"stepwell.{_DOORS[name]}"), name)
    raise AttributeError(f"module 'stepwell' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
