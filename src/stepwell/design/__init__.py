"""The inverse problem: maps, margins, anchors for a wanted sequence, tolerances, reprogramming.

The room can be called: `stepwell.design("00>10>11>01>00")` is `stepwell.design.design(...)`.
"""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from stepwell.base import late
from stepwell.design.margins.margin import LONGEST_FOLLOWED, Change, Margin, margin, proved_margin
from stepwell.design.margins.reprogramming import Reprogramming, Resistance, reprogram
from stepwell.design.margins.robustness import Robustness, RobustnessLimit, robustness
from stepwell.design.parameters import Parameter, parameter, parameters

if TYPE_CHECKING:
    from stepwell.design.checks import Check, Measurement, Verdict, check, judged
    from stepwell.design.map_boundaries import boundaries, parameter_boundaries
    from stepwell.design.maps import MapView, parameter_map, transition_map
    from stepwell.design.orders import checked_cycle
    from stepwell.design.plane import Boundary, BoundaryKind, Method
    from stepwell.design.run import Run
    from stepwell.design.synthesis.designed import Design, Impossible
    from stepwell.design.synthesis.inverse import design
    from stepwell.design.synthesis.region import (
        PAPER_BAND,
        PAPER_BOX,
        PAPER_LEVER,
        AnchorBox,
        AnchorPolygon,
        Stock,
        usual_box,
    )
    from stepwell.design.targets import Reached
    from stepwell.design.tolerances.draws import USUAL, Draws, Tolerances
    from stepwell.design.tolerances.survival import Survival, survival
    from stepwell.design.tolerances.tally import Share, share_of
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


class _Room(ModuleType):
    """A module that answers when it is called, since the room and its function share a name."""

    def __call__(self, *args: Any, **kwargs: Any) -> "Design":
        from stepwell.design.synthesis.inverse import design

        return design(*args, **kwargs)


sys.modules[__name__].__class__ = _Room

# The first cycle asks for a margin; what else there is opens when it is asked for.
_LATE = {
    "AnchorBox": "synthesis.region",
    "AnchorPolygon": "synthesis.region",
    "Boundary": "plane",
    "BoundaryKind": "plane",
    "Check": "checks",
    "Critical": "tolerances.yields",
    "Design": "synthesis.designed",
    "Draws": "tolerances.draws",
    "Impossible": "synthesis.designed",
    "MapView": "maps",
    "Measurement": "checks",
    "Method": "plane",
    "PAPER_BAND": "synthesis.region",
    "PAPER_BOX": "synthesis.region",
    "PAPER_LEVER": "synthesis.region",
    "Reached": "targets",
    "Run": "run",
    "Sensitivities": "tolerances.yields",
    "Share": "tolerances.tally",
    "Stock": "synthesis.region",
    "Survival": "tolerances.survival",
    "Tolerances": "tolerances.draws",
    "USUAL": "tolerances.draws",
    "Verdict": "checks",
    "Yield": "tolerances.yields",
    "boundaries": "map_boundaries",
    "check": "checks",
    "checked_cycle": "orders",
    "design": "synthesis.inverse",
    "judged": "checks",
    "parameter_boundaries": "map_boundaries",
    "parameter_map": "maps",
    "share_of": "tolerances.tally",
    "survival": "tolerances.survival",
    "transition_map": "maps",
    "usual_box": "synthesis.region",
    "yields": "tolerances.yields",
}


__getattr__, __dir__ = late(__name__, _LATE, __all__)
