"""Recordings as options of commands: what a folder holds, and a design as it calibrates it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.screen import progress, warn

if TYPE_CHECKING:
    from stepwell.accounts import Calibrated
    from stepwell.design import Tolerances
    from stepwell.lab import Recording
    from stepwell.mechanism import Chain

Data = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Recordings of your cells: their bands, weight and friction, and by how much bands "
        "differ, instead of the design's and of --stiffness-spread.",
    ),
]


def recordings_in(paths: Sequence[Path]) -> list[Recording]:
    """All recordings of some paths; what cannot be read is told on standard error."""
    from stepwell.lab import LabError, read_all

    with progress("reading") as tell:
        batch = read_all(paths, progress=tell)
    for error in batch.refused:
        warn(str(error))
    if not batch.recordings:
        raise LabError(", ".join(map(str, paths)), "holds no recording that can be read.")
    return list(batch.recordings)


def calibrated_on(
    data: Path, text: str, chain: Chain, spread: Tolerances
) -> tuple[str, Chain, Tolerances, Calibrated]:
    """A design and its tolerances as recordings calibrate them.

    Args:
        data: a folder of recordings.
        text: of the design file.
        chain: as it is drawn there.
        spread: how far parts may be off.

    Returns:
        The file and the chain with bands, weight and friction as measured; the tolerances with the
        scatter of the bands; and what the recordings gave.
    """
    from stepwell import files, lab
    from stepwell.accounts import Calibrated, account

    given = recordings_in([data])
    series = lab.sort_series(given).series
    with progress("fits") as tell:
        prepared = lab.prepare(series, lab.tension_tables(given))
        found = lab.calibrate(prepared, progress=tell)
    calibrated = Calibrated(
        data.name,
        lab.hashes(given),
        found.law,
        account(found).record["summary"],
        found.scatter,
    )
    measured = found.applied(chain)
    text = files.dumps(measured, program=files.loads(text).program)
    return text, measured, replace(spread, stiffness=found.scatter), calibrated
