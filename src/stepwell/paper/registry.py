"""Every claim, in the order of the paper."""

import os

from stepwell.paper import (
    _antennas,
    _cells,
    _loss,
    _map,
    _measured,
    _misprints,
    _more_cells,
    _order,
    _pathways,
    _robot,
    _steering,
    _wells,
)
from stepwell.paper.claim import Claim


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
        *_pathways.CLAIMS,
        *_order.CLAIMS,
        *_wells.CLAIMS,
        *_map.CLAIMS,
        *_misprints.CLAIMS,
        *_measured.claims(data),
        *_robot.CLAIMS,
        *_loss.CLAIMS,
        *_steering.CLAIMS,
        *_antennas.CLAIMS,
        *_more_cells.CLAIMS,
        *(_steering.MANY_RUNS if everything else ()),
    )
