"""The inverse problem: maps, margins, anchors for a wanted sequence, tolerances, reprogramming.

The room can be called: `stepwell.design(sequence="00>10>11>01>00")` is `design.design(...)`.
"""

import sys
from types import ModuleType
from typing import Any

from stepwell.design.boundary import Boundary, BoundaryKind
from stepwell.design.change import Change
from stepwell.design.limits import boundaries
from stepwell.design.maps import transition_map
from stepwell.design.margins import Margin, margin
from stepwell.design.tolerances import Tolerances
from stepwell.design.yields import Critical, Sensitivities, Yield, yields

__all__ = [
    "Boundary",
    "BoundaryKind",
    "Change",
    "Critical",
    "Margin",
    "Sensitivities",
    "Tolerances",
    "Yield",
    "boundaries",
    "margin",
    "transition_map",
    "yields",
]
