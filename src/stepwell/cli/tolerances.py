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
from stepwell.cli.ranges import by_cell, length, number, percent
from stepwell.cli.screen import progress, usable, warn

if TYPE_CHECKING:
    from stepwell.design import Tolerances


Friction = Annotated[
    float,
    typer.Option(
        metavar="FORCE,...",
        help="Friction tolerance: uniform additional friction of every cell, at most FORCE [N; kPa "
        "or mN m for elements with these units].",
        parser=by_cell(number),
    ),
]
TravelTolerance = Annotated[
    float,
    typer.Option(
        metavar="PERCENT,...",
        help="Travel tolerance: standard deviation of the travel of an element [%].",
        parser=by_cell(percent(24.9)),
    ),
]
Seed = Annotated[int, typer.Option(metavar="N", help="Random seed.", min=0)]
SAMPLES = "Number of Monte Carlo samples."


class Sampling(Group):
    """Number and seed of the samples."""

    samples: int | None = option(
        SAMPLES, "N", min=1, show_default=f"{base.QUICKLY}; {base.ONE_BY_ONE} if simulated"
    )
    seed: Seed = 0


class BandTolerances(Group):
    """Tolerances of bands and elements, common to all commands with tolerances."""

    anchor: float = option(
        "Anchor tolerance: radius of a uniform distribution [mm]. As all tolerances, one for all "
        "cells, or one per cell with commas, inner cell first.",
        "--anchor LENGTH,...",
        default=base.to_unit(base.USUAL_ANCHOR, "mm"),
        parser=by_cell(length()),
    )
    stiffness_tolerance: float = option(
        "Stiffness tolerance: standard deviation of the stiffness of a band, or of the force scale "
        "of an element [%].",
        "PERCENT,...",
        default=base.to_unit(base.USUAL_STIFFNESS, "percent"),
        parser=by_cell(percent(24.9)),
    )
    rest_length_tolerance: float = option(
        "Rest-length tolerance: standard deviation of the rest length of a band [%].",
        "PERCENT,...",
        default=0.0,
        parser=by_cell(percent(24.9)),
    )

    # Options of the groups below.
    lever_tolerance = friction = travel_tolerance = 0.0

    def tolerances(self, measure: base.Measure = base.Measure.TRAVEL) -> Tolerances:
        """These tolerances in SI; friction is given in the display unit of the measure's forces."""
        from stepwell.design import Tolerances

        shown, _ = base.display_unit(measure.force_unit)
        with usable("tolerances"):
            return Tolerances(
                in_si(self.anchor, "mm"),
                in_si(self.stiffness_tolerance, "percent"),
                in_si(self.rest_length_tolerance, "percent"),
                in_si(self.lever_tolerance, "mm"),
                in_si(self.friction, shown),
                in_si(self.travel_tolerance, "percent"),
            )


def in_si(given: float | tuple[float, ...], unit: str) -> float | tuple[float, ...]:
    """What `by_cell` has read, in SI."""
    if isinstance(given, tuple):
        return tuple(base.from_unit(one, unit) for one in given)
    return base.from_unit(given, unit)


class DesignTolerances(BandTolerances):
    """Tolerances that `design` takes into account."""

    lever_tolerance: float = option(
        "Lever tolerance: half width of a uniform distribution [mm].",
        "LENGTH,...",
        default=0.0,
        parser=by_cell(length()),
    )
    friction: Friction = 0.0


class ToleranceOptions(DesignTolerances):
    """All tolerances of a chain."""

    travel_tolerance: TravelTolerance = 0.0


BUILD_FILE = "FILE|PRESET"


def materials(incomplete: str) -> list[str]:
    """Presets of build files with this beginning."""
    from stepwell.build import build_presets

    return [name for name in build_presets() if name.startswith(incomplete)]


class BuildTolerances(ToleranceOptions):
    """All tolerances of a chain, or the errors of a build."""

    build: str | None = option(
        "Build file (TOML) or its preset, such as acrylic-3mm: the errors of its holes, joints, "
        "stops and bands replace all tolerances.",
        f"--build {BUILD_FILE}",
        autocompletion=materials,
    )

    def of(self, chain: sw.Chain) -> Tolerances:
        """The tolerances of a chain, or those of its parts."""
        if self.build is None:
            return self.tolerances(chain.measure)
        from stepwell.build import layout, load_build_file, tolerances_of

        with usable("--build"):
            return tolerances_of(layout(chain, load_build_file(self.build)))


Data = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Recordings (file or folder) of your cells: bands, weight and friction are fitted to "
        "them and replace those of the design; the scatter of the bands replaces "
        "--stiffness-tolerance.",
    ),
]


def recordings_in(paths: Sequence[Path]) -> list[sw.lab.Recording]:
    """All recordings of some paths; files that cannot be read are warnings."""
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
    """Design text, chain, tolerances and calibration, fitted to recordings.

    Bands, weight and friction of the chain are those of the recordings. The stiffness tolerance is
    the scatter of the recorded bands.
    """
    given = recordings_in([data])
    series = sw.lab.sort_series(given).series
    with progress("fits") as tell:
        prepared = sw.lab.prepare(series, sw.lab.tension_tables(given))
        fit = sw.lab.calibrate(prepared, progress=tell)
    summary = sw.accounts.account(fit).record["summary"]
    hashes = sw.lab.hashes(given)
    calibrated = sw.accounts.Calibrated(data.name, hashes, fit.law, summary, fit.scatter)
    measured = fit.applied(chain)
    text = sw.files.dumps(measured, program=sw.files.loads(text).program)
    return text, measured, replace(spread, stiffness=fit.scatter), calibrated
