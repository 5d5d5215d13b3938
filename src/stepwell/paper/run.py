"""Lists of all claims, of the paper and of others, and their verdicts."""

import os
from collections.abc import Callable

from stepwell.base import need, notify
from stepwell.paper import cells, jumping, measured, order, pathways, steering, walking
from stepwell.paper.claims import Claim, ClaimVerdict, Verdicts
from stepwell.paper.others import elements, pairs, trilinear

Progress = Callable[[int, int], None]


def claims(
    data: str | os.PathLike[str] | None = None, *, everything: bool = False
) -> tuple[Claim, ...]:
    """The claims about unit cells, two-cell mechanisms and the robot, without verdicts.

    Args:
        data: folder of the recordings published with the paper, for the claims that need them.
        everything: also the claims that need many simulated runs, which takes minutes.

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
        *jumping.JUMPING_CLAIMS,
        *(steering.MANY_RUNS if everything else ()),
    )


def others() -> tuple[Claim, ...]:
    """The claims of others about chains of bistable elements, without verdicts.

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
    """Compute all claims of others; `progress` is called with (done, total) claims."""
    return _judged(others(), progress)


def run(
    progress: Progress | None = None,
    *,
    everything: bool = False,
    data: str | os.PathLike[str] | None = None,
) -> Verdicts:
    """Compute all claims of the paper; `reports.write` draws the paper's figures.

    Args:
        progress: called with (done, total) claims.
        everything: also the claims that need many simulated runs, which takes minutes.
        data: folder of the recordings published with the paper; without it, claims on recordings
            have the verdict "needs data".

    Raises:
        LabError: the folder has no recording.
        ExtraError: xarray is not installed.

    Source: Kamp et al. 2024.
    """
    # The claims about the map need xarray.
    need("tables")
    return _judged(claims(data, everything=everything), progress)


def _judged(asked: tuple[Claim, ...], progress: Progress | None) -> Verdicts:
    verdicts: list[ClaimVerdict] = []
    for claim in asked:
        verdicts.append(claim.judge())
        notify(progress, len(verdicts), len(asked))
    return Verdicts(verdicts)
