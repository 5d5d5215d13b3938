"""Every claim, of the paper in its order and of others, judged; and the paper's figures."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from itertools import count
from typing import TYPE_CHECKING, Any

from stepwell import files
from stepwell.accounts import head
from stepwell.base import InputError, nearest_word, need
from stepwell.paper.cells import CELL_CLAIMS, MISPRINT_CLAIMS
from stepwell.paper.claims import Claim, Verdict
from stepwell.paper.measured import claims as measured_claims
from stepwell.paper.order import MORE_CELLS_CLAIMS, ORDER_CLAIMS
from stepwell.paper.others.elements import BALLOON_CLAIMS, COUNTERSNAPPING_CLAIMS, KRESLING_CLAIMS
from stepwell.paper.others.pairs import PAIR_CLAIMS
from stepwell.paper.others.trilinear import TRILINEAR_CLAIMS
from stepwell.paper.pathways import MAP_CLAIMS, PATHWAY_CLAIMS, WELL_CLAIMS
from stepwell.paper.steering import ANTENNA_CLAIMS, MANY_RUNS, STEERING_CLAIMS
from stepwell.paper.walking import LOSS_CLAIMS, WALKING_CLAIMS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "paper/1"


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
        *CELL_CLAIMS,
        *PATHWAY_CLAIMS,
        *ORDER_CLAIMS,
        *WELL_CLAIMS,
        *MAP_CLAIMS,
        *MISPRINT_CLAIMS,
        *measured_claims(data),
        *WALKING_CLAIMS,
        *LOSS_CLAIMS,
        *STEERING_CLAIMS,
        *ANTENNA_CLAIMS,
        *MORE_CELLS_CLAIMS,
        *(MANY_RUNS if everything else ()),
    )


def others() -> tuple[Claim, ...]:
    """The claims of others about chains of bistable elements; nothing is computed yet.

    Source: Puglisi and Truskinovsky 2000, J. Mech. Phys. Solids 48, 1; Muhaxheri and Santangelo
    2024, arXiv 2403.10721; Teunisse and van Hecke 2025, R. Soc. Open Sci. 12, 250753; Bhovad,
    Kaufmann and Li 2019, arXiv 1906.04091; Ducarme et al. 2025, PNAS 122, e2423301122.
    """
    return (
        *TRILINEAR_CLAIMS,
        *BALLOON_CLAIMS,
        *PAIR_CLAIMS,
        *KRESLING_CLAIMS,
        *COUNTERSNAPPING_CLAIMS,
    )


def validate(progress: Callable[[int, int], None] | None = None) -> tuple[Verdict, ...]:
    """Compute every claim of others anew.

    Args:
        progress: called with (done, total) claims.

    Returns:
        A verdict for each claim, in the order of `others()`.
    """
    asked, found = others(), list[Verdict]()
    for claim in asked:
        found.append(claim.judge())
        if progress is not None:
            progress(len(found), len(asked))
    return tuple(found)


def run(
    out: str | os.PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
    *,
    everything: bool = False,
    data: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> tuple[Verdict, ...]:
    """Compute every claim anew.

    Args:
        out: folder for the figures (a .png and a .svg each) and claims.json; all of them appear
            in it or none.
        progress: called with (done, total) claims and figures.
        everything: also the claims and figures that take many simulated runs, minutes of them.
        force: replace files in `out` that others wrote or changed too.
        data: folder of the recordings published with the paper; without it the claims that they
            decide say that they need data.

    Returns:
        A verdict for each claim, in the order of `claims()`.

    Raises:
        LabError: a folder of data without a recording.
        OverwriteError: a file in `out` is not one that this function wrote.
        OSError: the folder cannot be written.
        ExtraError: xarray is not installed, or Matplotlib for figures.

    Source: Kamp et al. 2024.
    """
    # The claims about the map take a labelled table.
    need("tables") if out is None else need("figures", "tables")
    asked = claims(data, everything=everything)
    drawn: dict[str, Callable[[], Figure]] = {}
    names = outputs(everything) if out is not None else ()
    if out is not None:
        from stepwell.paper.figures import figures_of

        files.check_folder(out, "paper", names=names, force=force)
        drawn = figures_of(everything)
    steps = count(1)

    def done() -> None:
        if progress is not None:
            progress(next(steps), len(asked) + len(drawn))

    found: list[Verdict] = []
    for claim in asked:
        found.append(claim.judge())
        done()
    if out is not None:
        from stepwell import figures

        told = record(found)
        with files.staged_folder(out, "paper", told, names=names, force=force) as draft:
            files.write_atomic(draft / "claims.json", json.dumps(told, indent=2) + "\n")
            for name, draw in drawn.items():
                figure = draw()
                for suffix in (".png", ".svg"):
                    figures.save(figure, draft / f"{name}{suffix}")
                done()
    return tuple(found)


def record(verdicts: Iterable[Verdict]) -> dict[str, Any]:
    """The verdicts as JSON can hold them; docs/commands.md describes the names."""
    return {
        **head(SCHEMA, None),
        "claims": [
            {
                "id": verdict.claim.id,
                "claim": verdict.claim.claim,
                "where": verdict.claim.where,
                "paper": verdict.claim.paper_value,
                "tolerance": verdict.claim.tolerance,
                "ours": verdict.ours,
                "verdict": verdict.verdict,
                "reason": verdict.reason,
            }
            for verdict in verdicts
        ],
    }


def outputs(everything: bool = False) -> tuple[str, ...]:
    """The names of the files that `run` writes."""
    from stepwell.paper.figures import figures_of

    return ("claims.json", *files.pictures(*figures_of(everything)))


def figure_of(name: str) -> Figure:
    """A figure of the paper, drawn from the model.

    Args:
        name: fig1 (Figs. 1D, 1E), fig2 (2B, 2D to 2G), fig2c, fig3 (3C to 3E), fig4 (4D), or
            robot-tornado; those of robots are simulated, the last two many times.

    Raises:
        ValueError: there is none of that name.
        ExtraError: it needs the simulator, which is not installed.
    """
    from stepwell.paper import figures

    every = figures.FIGURES | figures.ROBOT_FIGURES | figures.MANY_RUNS
    if name not in every:
        near = nearest_word(name, every)
        guess = f"Did you mean {near}?" if near else f"There are {', '.join(every)}."
        raise InputError(f"{name!r}: no such figure of the paper. {guess}")
    return every[name]()
