"""Mechanisms as a workshop makes them: tolerances, yields, the survival of programs."""

from stepwell.design.tolerances.counted import Share, share_of
from stepwell.design.tolerances.draws import Draws
from stepwell.design.tolerances.known import parts_of, with_known
from stepwell.design.tolerances.survival import Survival, ends_right, survival
from stepwell.design.tolerances.tolerances import (
    USUAL,
    Tolerances,
    levers_of,
    refuse_reach,
    refuse_slips,
)
from stepwell.design.tolerances.yields import Critical, Sensitivities, Yield, yields
