"""The inverse problem: maps, margins, anchors for a wanted sequence, tolerances, reprogramming.

The room can be called: `stepwell.design(sequence="00>10>11>01>00")` is `design.design(...)`.
"""

from stepwell.design.boundary import Boundary, BoundaryKind
from stepwell.design.change import Change
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
from stepwell.design.reprogramming import Reprogramming, reprogram
from stepwell.design.survival import Survival, survival
from stepwell.design.tolerances import Tolerances
from stepwell.design.yields import Critical, Sensitivities, Yield, yields

__all__ = [
    "Boundary",
    "BoundaryKind",
    "Change",
    "Critical",
    "Knob",
    "Margin",
    "ParameterBoundary",
    "Push",
    "Reprogramming",
    "Sensitivities",
    "Survival",
    "Tolerances",
    "Yield",
    "boundaries",
    "knob",
    "knobs",
    "margin",
    "parameter_boundaries",
    "parameter_map",
    "reprogram",
    "survival",
    "transition_map",
    "yields",
]
