"""The inverse problem: maps, margins, anchors for a wanted sequence, tolerances, reprogramming.

The room can be called: `stepwell.design("00>10>11>01>00")` is `stepwell.design.design(...)`.
"""

import sys
from types import ModuleType
from typing import Any

from stepwell.design.maps.boundaries import boundaries
from stepwell.design.maps.parameter_map import (
    ParameterBoundary,
    parameter_boundaries,
    parameter_map,
)
from stepwell.design.maps.transition_map import transition_map
from stepwell.design.margins.change import Change
from stepwell.design.margins.margin import Margin, margin
from stepwell.design.margins.reprogramming import Reprogramming, reprogram
from stepwell.design.margins.resistance import Push
from stepwell.design.margins.robustness import Robustness, robustness
from stepwell.design.orders.reached import Reached
from stepwell.design.parameters.parameter import Knob, knob, knobs
from stepwell.design.placement.region import PAPER_BOX, AnchorBox, AnchorPolygon
from stepwell.design.placement.stock import PAPER_BAND, Stock
from stepwell.design.plane.boundary import Boundary, BoundaryKind
from stepwell.design.synthesis.designed import Design
from stepwell.design.synthesis.impossible import Impossible
from stepwell.design.synthesis.inverse import design
from stepwell.design.tolerances.survival import Survival, survival
from stepwell.design.tolerances.tolerances import USUAL, Tolerances
from stepwell.design.tolerances.yields import Critical, Sensitivities, Yield, yields

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
