"""What the commands of the lab take: recordings and baselines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.screen import progress, warn

if TYPE_CHECKING:
    from stepwell.lab import Recording

Data = Annotated[
    Path,
    typer.Argument(
        metavar="DATA",
        help="A folder of recordings, at any depth, or one recording.",
    ),
]
Baseline = Annotated[
    Path | None,
    typer.Option(
        "--baseline",
        metavar="PATH",
        help="Runs without a band; by default those in DATA whose name says friction.",
    ),
]
NoBaseline = Annotated[
    bool, typer.Option("--no-baseline", help="Subtract no friction, whatever is there.")
]


def recordings(paths: Sequence[Path]) -> list[Recording]:
    """All recordings of some paths; what cannot be read is told on standard error."""
    from stepwell.lab import LabError, read_all

    with progress("reading") as tell:
        batch = read_all(paths, progress=tell)
    for error in batch.refused:
        warn(str(error))
    if not batch.recordings:
        raise LabError(", ".join(map(str, paths)), "holds no recording that can be read.")
    return list(batch.recordings)


def subtracted(path: Path | None, none: bool) -> list[Recording] | None:
    """The runs to subtract: those given, none, or None where names decide."""
    if path is not None and none:
        raise typer.BadParameter("cannot stand with --no-baseline.", param_hint="--baseline")
    if none:
        return []
    return None if path is None else recordings([path])
