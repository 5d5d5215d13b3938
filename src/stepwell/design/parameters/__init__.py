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
from stepwell.design.parameters.parameter import Parameter, of_cell, parameter, parameters

__all__ = [
    "WAY",
    "Parameter",
    "axis",
    "moved",
    "of_cell",
    "parameter",
    "parameters",
    "refuse_far",
    "require_places",
    "which",
    "with_q",
]
