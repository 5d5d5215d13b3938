"""The parameters of a chain by name."""

from stepwell.design.parameters.pairs import (
    WAY,
    axis,
    moved,
    refuse_far,
    require_places,
    which,
    with_q,
)
from stepwell.design.parameters.parameter import Knob, knob, knobs

__all__ = [
    "WAY",
    "Knob",
    "axis",
    "knob",
    "knobs",
    "moved",
    "refuse_far",
    "require_places",
    "which",
    "with_q",
]
