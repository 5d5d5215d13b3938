"""Every claim, in the order of the paper."""

import os

from stepwell.paper.claims import Claim
from stepwell.paper.mechanisms import (
    CELLS,
    MAP,
    MISPRINTS,
    MORE_CELLS,
    ORDER,
    PATHWAYS,
    WELLS,
    measured_claims,
)
from stepwell.paper.robots import ANTENNAS, LOSS, MANY_RUNS, ROBOT, STEERING


def claims(
    data: str | os.PathLike[str] | None = None, *, everything: bool = False
) -> tuple[Claim, ...]:
    """The claims about unit cells, two-cell mechanisms and the robot; nothing is computed yet.

    Args:
        data: folder of the recordings published with the paper, for the claims they decide.
        everything: also those that take many simulated runs, minutes of them.

    Source: Kamp et al. 2024.
    """
    return (
        *CELLS,
        *PATHWAYS,
        *ORDER,
        *WELLS,
        *MAP,
        *MISPRINTS,
        *measured_claims(data),
        *ROBOT,
        *LOSS,
        *STEERING,
        *ANTENNAS,
        *MORE_CELLS,
        *(MANY_RUNS if everything else ()),
    )
