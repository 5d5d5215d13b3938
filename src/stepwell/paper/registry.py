"""Every claim, in the order of the paper."""

from stepwell.paper import _cells, _map, _measured, _misprints, _order, _pathways, _wells
from stepwell.paper.claim import Claim


def claims() -> tuple[Claim, ...]:
    """All claims about unit cells and two-cell mechanisms; nothing is computed yet.

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
    )
