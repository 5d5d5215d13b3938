"""Inverse design: maps, margins, anchors for a target sequence, tolerances, reprogramming.

The package can be called: `stepwell.design("00>10>11>01>00")` is `stepwell.design.design(...)`.
"""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from stepwell.base import late
from stepwell.design.margins.margin import LONGEST_FOLLOWED, Change, Margin, margin, proved_margin
from stepwell.design.margins.reprogramming import Reprogramming, Resistance, reprogram
from stepwell.design.margins.robustness import Robustness, RobustnessLimit, robustness
from stepwell.design.orders import checked_cycle
from stepwell.design.parameters import Parameter, parameter, parameters
from stepwell.design.plane import Boundary, BoundaryKind, Method
from stepwell.design.tolerances.draws import DEFAULT_TOLERANCES, CellTolerances, Draws, Tolerances

if TYPE_CHECKING:
    from stepwell.design.checks import Check, Measurement, Verdict, check, measurement, verdict_of
    from stepwell.design.machine_design import MachineDesign, design_machine, machine_yield
    from stepwell.design.map_boundaries import boundaries, parameter_boundaries
    from stepwell.design.maps import MapView, parameter_map, transition_map
    from stepwell.design.requirements import Requirement, Requirements
    from stepwell.design.run import Run
    from stepwell.design.synthesis.designed import Design, Impossible
    from stepwell.design.synthesis.evidence import (
        HoleEvidence,
        RequirementEvidence,
        ScaleEvidence,
        StateEvidence,
    )
    from stepwell.design.synthesis.inverse import design
    from stepwell.design.synthesis.region import (
        PAPER_BAND,
        PAPER_BOX,
        PAPER_LEVER,
        AnchorBox,
        AnchorPolygon,
        BandType,
        usual_box,
    )
    from stepwell.design.synthesis.strongest import (
        Means,
        StrongestSnap,
        strongest_snap,
        strongest_snaps,
    )
    from stepwell.design.synthesis.tapped import TappedDesign, design_tapped
    from stepwell.design.targets import Reached
    from stepwell.design.tolerances.survival import Survival, survival
    from stepwell.design.tolerances.tally import Fraction, fraction_of
    from stepwell.design.tolerances.yields import Critical, Sensitivities, Yield, yields

__all__ = [
    "PAPER_BAND",
    "PAPER_BOX",
    "DEFAULT_TOLERANCES",
    "AnchorBox",
    "AnchorPolygon",
    "Boundary",
    "BoundaryKind",
    "CellTolerances",
    "Change",
    "Check",
    "Critical",
    "Design",
    "Draws",
    "HoleEvidence",
    "Impossible",
    "MachineDesign",
    "MapView",
    "Margin",
    "Means",
    "Measurement",
    "Method",
    "Parameter",
    "Reached",
    "Reprogramming",
    "Requirement",
    "Requirements",
    "Resistance",
    "Robustness",
    "RobustnessLimit",
    "RequirementEvidence",
    "ScaleEvidence",
    "Sensitivities",
    "StateEvidence",
    "StrongestSnap",
    "Run",
    "Fraction",
    "BandType",
    "Survival",
    "TappedDesign",
    "Tolerances",
    "Verdict",
    "Yield",
    "boundaries",
    "check",
    "checked_cycle",
    "design",
    "design_machine",
    "design_tapped",
    "machine_yield",
    "verdict_of",
    "margin",
    "parameter",
    "parameter_boundaries",
    "parameter_map",
    "parameters",
    "proved_margin",
    "reprogram",
    "robustness",
    "strongest_snap",
    "strongest_snaps",
    "fraction_of",
    "survival",
    "transition_map",
    "yields",
]


class _CallablePackage(ModuleType):
    """A module that can be called, since the package and its function share a name."""

    def __call__(self, *args: Any, **kwargs: Any) -> "Design":
        return self.design(*args, **kwargs)


sys.modules[__name__].__class__ = _CallablePackage

# The first cycle needs a margin; other modules are imported at first use.
_LATE = {
    "checks": ("Check", "Measurement", "Verdict", "check", "measurement", "verdict_of"),
    "machine_design": ("MachineDesign", "design_machine", "machine_yield"),
    "map_boundaries": ("boundaries", "parameter_boundaries"),
    "maps": ("MapView", "parameter_map", "transition_map"),
    "requirements": ("Requirement", "Requirements"),
    "run": ("Run",),
    "synthesis.designed": ("Design", "Impossible"),
    "synthesis.evidence": (
        *("HoleEvidence", "RequirementEvidence", "ScaleEvidence", "StateEvidence"),
    ),
    "synthesis.inverse": ("design",),
    "synthesis.region": (
        "AnchorBox",
        "AnchorPolygon",
        "PAPER_BAND",
        "PAPER_BOX",
        "PAPER_LEVER",
        "BandType",
        "usual_box",
    ),
    "synthesis.strongest": ("Means", "StrongestSnap", "strongest_snap", "strongest_snaps"),
    "synthesis.tapped": ("TappedDesign", "design_tapped"),
    "targets": ("Reached",),
    "tolerances.survival": ("Survival", "survival"),
    "tolerances.tally": ("Fraction", "fraction_of"),
    "tolerances.yields": ("Critical", "Sensitivities", "Yield", "yields"),
}


__getattr__, __dir__ = late(__name__, _LATE, __all__)
