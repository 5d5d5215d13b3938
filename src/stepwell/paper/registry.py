"""Every claim, in the order of the paper."""

import os

from stepwell.paper import _cells, _map, _measured, _misprints, _order, _pathways, _wells
from stepwell.paper.claim import Claim


def claims(data: str | os.PathLike[str] | None = None) -> tuple[Claim, ...]:
    """All claims about unit cells and two-cell mechanisms; nothing is computed yet.

    Args:
        data: folder of the recordings published with the paper, for the claims they decide.

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
    )
