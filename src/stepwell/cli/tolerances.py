"""Manufacturing tolerances as options, and recordings that replace them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import stepwell as sw
from stepwell import base
from stepwell.cli.options import Group, option
from stepwell.cli.screen import progress, usable, warn

if TYPE_CHECKING:
    from stepwell.design import Tolerances


Friction = Annotated[
    float,
    typer.Option(
        metavar="N",
        help="Every cell has up to this more friction [N; kPa or mN m where forces are].",
        min=0,
    ),
]
TravelTolerance = Annotated[
    float,
    typer.Option(
        metavar="PERCENT",
        help="Standard deviation of all travels of an element alike [%].",
        min=0,
        max=24.9,
    ),
]
Seed = Annotated[int, typer.Option(help="Random seed.", min=0)]


class Sampling(Group):
    """How many mechanisms are made at random, and which."""

    samples: int | None = option(
        f"How many mechanisms are made at random; {base.QUICKLY}, or {base.ONE_BY_ONE} "
        "where each is followed by the engine.",
        "N",
        min=1,
    )
    seed: Seed = 0


class BandTolerances(Group):
    """The tolerances of bands and elements that all commands with tolerances take."""

    anchor: float = option(
        "Anchor tolerance: radius of a uniform distribution [mm].",
        "--anchor MM",
        default=base.to_unit(base.USUAL_ANCHOR, "mm"),
        min=0,
    )
    stiffness_tolerance: float = option(
        "Standard deviation of a band's stiffness, or of all forces of an element alike [%].",
        "PERCENT",
        default=base.to_unit(base.USUAL_STIFFNESS, "percent"),
        min=0,
        max=24.9,
    )
    rest_length_tolerance: float = option(
        "Standard deviation of a band's rest length [%].", "PERCENT", default=0.0, min=0, max=24.9
    )

    # Options of the groups below.
    lever_tolerance = friction = travel_tolerance = 0.0

    def tolerances(self, measure: base.Measure = base.Measure.TRAVEL) -> Tolerances:
        """The same in SI; friction is in the unit in which forces of the measure are shown."""
        from stepwell.design import Tolerances

        _, factor = base.display_unit(measure.force_unit)
        with usable("tolerances"):
            return Tolerances(
                base.from_unit(self.anchor, "mm"),
                base.from_unit(self.stiffness_tolerance, "percent"),
                base.from_unit(self.rest_length_tolerance, "percent"),
                base.from_unit(self.lever_tolerance, "mm"),
                self.friction / factor,
                base.from_unit(self.travel_tolerance, "percent"),
            )


class DesignTolerances(BandTolerances):
    """The tolerances of a mechanism that is being designed."""

    lever_tolerance: float = option(
        "Every cell's lever is off by up to this [mm].", "MM", default=0.0, min=0
    )
    friction: Friction = 0.0


class ToleranceOptions(DesignTolerances):
    """The tolerances within which mechanisms are made."""

    travel_tolerance: TravelTolerance = 0.0


Data = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Recordings of your cells: their bands, weight and friction, and by how much bands "
        "differ, instead of the design's and of --stiffness-tolerance.",
    ),
]


def recordings_in(paths: Sequence[Path]) -> list[sw.lab.Recording]:
    """All recordings of some paths; what cannot be read is a warning."""
    with progress("reading") as tell:
        batch = sw.lab.read_all(paths, progress=tell)
    for error in batch.refused:
        warn(str(error))
    if not batch.recordings:
        raise sw.lab.LabError(", ".join(map(str, paths)), "holds no recording that can be read.")
    return list(batch.recordings)


def calibrated_on(
    data: Path, text: str, chain: sw.Chain, spread: Tolerances
) -> tuple[str, sw.Chain, Tolerances, sw.accounts.Calibrated]:
    """The file and the chain of a design with bands, weight and friction as recordings have them.

    With the tolerances, which get the scatter of the bands, and what the recordings gave.
    """
    given = recordings_in([data])
    series = sw.lab.sort_series(given).series
    with progress("fits") as tell:
        prepared = sw.lab.prepare(series, sw.lab.tension_tables(given))
        found = sw.lab.calibrate(prepared, progress=tell)
    summary = sw.accounts.account(found).record["summary"]
    hashes = sw.lab.hashes(given)
    calibrated = sw.accounts.Calibrated(data.name, hashes, found.law, summary, found.scatter)
    measured = found.applied(chain)
    text = sw.files.dumps(measured, program=sw.files.loads(text).program)
    return text, measured, replace(spread, stiffness=found.scatter), calibrated
