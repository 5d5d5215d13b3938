"""Every claim, of the paper in its order and of others, judged."""

import os
from collections.abc import Callable

from stepwell.base import need, notify
from stepwell.paper import cells, measured, order, pathways, steering, walking
from stepwell.paper.claims import Claim, ClaimVerdict, Verdicts
from stepwell.paper.others import elements, pairs, trilinear

Progress = Callable[[int, int], None]


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
        *cells.CELL_CLAIMS,
        *pathways.PATHWAY_CLAIMS,
        *order.ORDER_CLAIMS,
        *pathways.WELL_CLAIMS,
        *pathways.MAP_CLAIMS,
        *cells.MISPRINT_CLAIMS,
        *measured.claims(data),
        *walking.WALKING_CLAIMS,
        *walking.LOSS_CLAIMS,
        *steering.STEERING_CLAIMS,
        *steering.ANTENNA_CLAIMS,
        *order.MORE_CELLS_CLAIMS,
        *(steering.MANY_RUNS if everything else ()),
    )


def others() -> tuple[Claim, ...]:
    """The claims of others about chains of bistable elements; nothing is computed yet.

    Source: Puglisi and Truskinovsky 2000, J. Mech. Phys. Solids 48, 1; Muhaxheri and Santangelo
    2024, arXiv 2403.10721; Teunisse and van Hecke 2025, R. Soc. Open Sci. 12, 250753; Bhovad,
    Kaufmann and Li 2019, arXiv 1906.04091; Ducarme et al. 2025, PNAS 122, e2423301122.
    """
    return (
        *trilinear.TRILINEAR_CLAIMS,
        *elements.BALLOON_CLAIMS,
        *pairs.PAIR_CLAIMS,
        *elements.KRESLING_CLAIMS,
        *elements.COUNTERSNAPPING_CLAIMS,
    )


def validate(progress: Progress | None = None) -> Verdicts:
    """Compute every claim of others; `progress` is called with (done, total) claims."""
    return _judged(others(), progress)


def run(
    progress: Progress | None = None,
    *,
    everything: bool = False,
    data: str | os.PathLike[str] | None = None,
) -> Verdicts:
    """Compute every claim; `reports.write` draws the paper's figures into a folder.

    Args:
        progress: called with (done, total) claims.
        everything: also the claims that take many simulated runs, minutes of them.
        data: folder of the recordings published with the paper; without it the claims that they
            decide say that they need data.

    Raises:
        LabError: a folder of data without a recording.
        ExtraError: xarray is not installed.

    Source: Kamp et al. 2024.
    """
    # The claims about the map take a labelled table.
    need("tables")
    return _judged(claims(data, everything=everything), progress)


def _judged(asked: tuple[Claim, ...], progress: Progress | None) -> Verdicts:
    verdicts: list[ClaimVerdict] = []
    for claim in asked:
        verdicts.append(claim.judge())
        notify(progress, len(verdicts), len(asked))
    return Verdicts(verdicts)
