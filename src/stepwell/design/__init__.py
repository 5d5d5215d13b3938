"""The inverse problem: maps, margins, anchors for a wanted sequence, tolerances, reprogramming.

The room can be called: `stepwell.design("00>10>11>01>00")` is `stepwell.design.design(...)`.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from stepwell.design.margins import (
    LONGEST_FOLLOWED,
    Change,
    Margin,
    Reprogramming,
    Resistance,
    Robustness,
    RobustnessLimit,
    margin,
    proved_margin,
    reprogram,
    robustness,
)
from stepwell.design.parameters import Parameter, parameter, parameters

if TYPE_CHECKING:
    from stepwell.design.checks import Check, Measurement, Verdict, check, judged
    from stepwell.design.maps import (
        MapView,
        boundaries,
        parameter_boundaries,
        parameter_map,
        transition_map,
    )
    from stepwell.design.orders import Reached, checked_cycle
    from stepwell.design.placement import PAPER_BAND, PAPER_BOX, AnchorBox, AnchorPolygon, Stock
    from stepwell.design.plane import Boundary, BoundaryKind, Method
    from stepwell.design.run import Run
    from stepwell.design.synthesis import Design, Impossible, design
    from stepwell.design.tolerances import (
        USUAL,
        Critical,
        Draws,
        Sensitivities,
        Share,
        Survival,
        Tolerances,
        Yield,
        share_of,
        survival,
        yields,
    )

__all__ = [
    "PAPER_BAND",
    "PAPER_BOX",
    "USUAL",
    "AnchorBox",
    "AnchorPolygon",
    "Boundary",
    "BoundaryKind",
    "Change",
    "Check",
    "Critical",
    "Design",
    "Draws",
    "Impossible",
    "MapView",
    "Margin",
    "Measurement",
    "Method",
    "Parameter",
    "Reached",
    "Reprogramming",
    "Resistance",
    "Robustness",
    "RobustnessLimit",
    "Sensitivities",
    "Run",
    "Share",
    "Stock",
    "Survival",
    "Tolerances",
    "Verdict",
    "Yield",
    "boundaries",
    "check",
    "checked_cycle",
    "design",
    "judged",
    "margin",
    "parameter",
    "parameter_boundaries",
    "parameter_map",
    "parameters",
    "proved_margin",
    "reprogram",
    "robustness",
    "share_of",
    "survival",
    "transition_map",
    "yields",
]

_LATE = "orders", "plane", "tolerances", "placement", "maps", "checks", "synthesis", "run"


class _Room(ModuleType):
    """A module that answers when it is called, since the room and its function share a name."""

    def __call__(self, *args: Any, **kwargs: Any) -> Design:
        from stepwell.design.synthesis import design

        return design(*args, **kwargs)


sys.modules[__name__].__class__ = _Room


def __getattr__(name: str) -> Any:
    # The first cycle asks for a margin; what else there is opens when it is asked for.
    for part in _LATE if name in __all__ else ():
        offered = vars(import_module(f"stepwell.design.{part}"))
        if name in offered:
            return offered[name]
    raise AttributeError(f"module 'stepwell.design' has no attribute {name!r}")
