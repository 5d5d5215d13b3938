"""Every claim, in the order of the paper."""

import os

from stepwell.paper.claims.claim import Claim
from stepwell.paper.mechanisms import (
    cells as _cells,
    map,
    measured,
    misprints,
    more_cells,
    order as _order,
    pathways,
    wells,
)
from stepwell.paper.robots import antennas, loss, robot as _robot, steering


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
        *_cells.CLAIMS,
        *pathways.CLAIMS,
        *_order.CLAIMS,
        *wells.CLAIMS,
        *map.CLAIMS,
        *misprints.CLAIMS,
        *measured.claims(data),
        *_robot.CLAIMS,
        *loss.CLAIMS,
        *steering.CLAIMS,
        *antennas.CLAIMS,
        *more_cells.CLAIMS,
        *(steering.MANY_RUNS if everything else ()),
    )
