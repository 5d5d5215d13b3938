"""Every claim, in the order of the paper."""

from stepwell.paper import (
    _cells,
    _map,
    _measured,
    _misprints,
    _order,
    _pathways,
    _robot,
    _steering,
    _wells,
)
from stepwell.paper.claim import Claim


def claims(*, everything: bool = False) -> tuple[Claim, ...]:
    """The claims about unit cells, two-cell mechanisms and the robot; nothing is computed yet.

    Args:
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
        *_measured.CLAIMS,
        *_robot.CLAIMS,
        *_steering.CLAIMS,
        *(_steering.MANY_RUNS if everything else ()),
    )
