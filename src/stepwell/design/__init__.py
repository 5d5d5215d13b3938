"""The inverse problem: maps, margins, anchors for a wanted sequence, tolerances, reprogramming.

The room can be called: `stepwell.design("00>10>11>01>00")` is `stepwell.design.design(...)`.
"""

import sys
from types import ModuleType
from typing import Any

from stepwell.design._reached import Reached
from stepwell.design.boundary import Boundary, BoundaryKind
from stepwell.design.change import Change
from stepwell.design.designed import Design
from stepwell.design.impossible import Impossible
from stepwell.design.inverse import design
from stepwell.design.knobs import Knob, knob, knobs
from stepwell.design.limits import boundaries
from stepwell.design.maps import transition_map
from stepwell.design.margins import Margin, margin
from stepwell.design.parameter_maps import (
    ParameterBoundary,
    parameter_boundaries,
    parameter_map,
)
from stepwell.design.push import Push
from stepwell.design.region import PAPER_BOX, AnchorBox, AnchorPolygon
from stepwell.design.reprogramming import Reprogramming, reprogram
from stepwell.design.robustness import Robustness, robustness
from stepwell.design.stock import PAPER_BAND, Stock
from stepwell.design.survival import Survival, survival
from stepwell.design.tolerances import USUAL, Tolerances
from stepwell.design.yields import Critical, Sensitivities, Yield, yields

__all__ = [
    "PAPER_BAND",
    "PAPER_BOX",
    "USUAL",
    "AnchorBox",
    "AnchorPolygon",
    "Boundary",
    "BoundaryKind",
    "Change",
    "Critical",
    "Design",
    "Impossible",
    "Knob",
    "Margin",
    "ParameterBoundary",
    "Push",
    "Reached",
    "Reprogramming",
    "Robustness",
    "Sensitivities",
    "Stock",
    "Survival",
    "Tolerances",
    "Yield",
    "boundaries",
    "design",
    "knob",
    "knobs",
    "margin",
    "parameter_boundaries",
    "parameter_map",
    "reprogram",
    "robustness",
    "survival",
    "transition_map",
    "yields",
]


class _Room(ModuleType):
    """A module that answers when it is called, since the room and its function share a name."""

    def __call__(self, *args: Any, **kwargs: Any) -> Design:
        return design(*args, **kwargs)


sys.modules[__name__].__class__ = _Room
