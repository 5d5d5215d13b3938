"""All claims judged, and the paper's figures drawn from the model."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from typing import Any

from stepwell.files import pictures
from stepwell.paper.claims import Verdict
from stepwell.paper.registry import claims
from stepwell.results import head

SCHEMA = "stepwell.paper/1"


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

    Source: Kamp et al. 2024.
    """
    asked = claims(data, everything=everything)
    total = len(asked)
    if out is not None:
        from stepwell import files
        from stepwell.paper.figures import figures_of

        files.check_folder(out, "paper", names=outputs(everything), force=force)
        total += len(figures_of(everything))
    found: list[Verdict] = []
    for claim in asked:
        found.append(claim.judge())
        if progress is not None:
            progress(len(found), total)
    if out is not None:
        _write(out, found, progress, total, everything, force)
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

    return ("claims.json", *pictures(*figures_of(everything)))


def _write(
    out: str | os.PathLike[str],
    verdicts: list[Verdict],
    progress: Callable[[int, int], None] | None,
    total: int,
    everything: bool,
    force: bool,
) -> None:
    from stepwell import figures, files
    from stepwell.paper.figures import figures_of

    told = record(verdicts)
    names = outputs(everything)
    with files.staged_folder(out, "paper", told, names=names, force=force) as draft:
        files.write_atomic(draft / "claims.json", json.dumps(told, indent=2) + "\n")
        for done, (name, draw) in enumerate(figures_of(everything).items(), len(verdicts) + 1):
            figure = draw()
            for suffix in (".png", ".svg"):
                figures.save(figure, draft / f"{name}{suffix}")
            if progress is not None:
                progress(done, total)
