"""The inverse problem: transition maps, margins, anchors for a wanted sequence."""

from stepwell.design.boundary import Boundary, BoundaryKind
from stepwell.design.change import Change
from stepwell.design.limits import boundaries
from stepwell.design.maps import transition_map
from stepwell.design.margins import Margin, margin

__all__ = [
    "Boundary",
    "BoundaryKind",
    "Change",
    "Margin",
    "boundaries",
    "margin",
    "transition_map",
]
