"""`stepwell lab`: recordings, calibrated bands, comparisons, as-built parameters."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import stepwell as sw
from stepwell.base import Measure, display_unit
from stepwell.cli import options as opts, tolerances as given
from stepwell.cli.options import Design, Group, Output, designs as design_names
from stepwell.cli.ranges import length, millimetres, percent, window as read_window
from stepwell.cli.readings import ReadingCommand, ReadingOptions
from stepwell.cli.screen import WRONG_INPUT, progress, subcommands, usable, wrong

if TYPE_CHECKING:
    from stepwell.lab import BandTest, MeasuredElement, Pull, Recording, Rig
    from stepwell.mechanism import Chain


commands = subcommands(
    "Fit bands and cells to recordings of a test machine, and compare them with the model."
)


@opts.command(commands, ReadingCommand)
def read(
    *,
    files: list[Path] = opts.argument(
        "Recordings (files or folders): tables of text or workbooks, as a test machine exports "
        "them.",
        "FILE...",
    ),
    how: ReadingOptions,
    output: Output,
) -> None:
    """List the extremes, jumps, work and stiffness of each half cycle of recordings.

    The columns of stroke and force are decided by names, units and numbers, and printed. If they
    leave a choice, the file is refused with its columns; --stroke and --force settle it. A file
    that cannot be read is listed with the reason; the other files are read. With --out, a figure
    and all samples as one tidy table with units (CSV, netCDF, Parquet) are written into a folder.

    Example: stepwell lab read recordings --out tidy
    """
    output.check_output_folder("lab read")
    batch = how.read_all(files)
    if not batch.recordings:
        output = replace(output, out=None)
    output.report(batch)
    if not batch.recordings:
        raise typer.Exit(WRONG_INPUT)


class Measuring(Group):
    """How an element is measured in a recording."""

    noise: float | None = opts.option(
        "Least standard deviation of the forces [N, kPa or N mm]; estimated by default.",
        "NUMBER",
        min=1e-9,
    )
    least_drop: float | None = opts.option(
        "Smallest drop of the force that ends a phase [N, kPa or N mm], for correlated noise.",
        "NUMBER",
        min=1e-9,
    )
    stops: str | None = opts.option(
        "Ends of the curve with a stop: low, high or both; none by default.", "ENDS"
    )
    name: str = opts.option("Name of the element; that of the file by default.", "TEXT", default="")

    def measured(self, recording: Recording) -> MeasuredElement:
        """The element in a recording."""
        ends = {None: (False, False), "low": (True, False), "high": (False, True)}
        ends |= {"none": (False, False), "both": (True, True)}
        if self.stops not in ends:
            raise wrong("--stops", f"{self.stops!r}: must be low, high, both or none.")
        _, factor = display_unit(recording.measure.force_unit)
        noise, drop = (None if x is None else x / factor for x in (self.noise, self.least_drop))
        return sw.lab.measure_element(
            recording, self.name, noise=noise, least_drop=drop, stops=ends[self.stops]
        )


@opts.command(commands, ReadingCommand)
def element(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Recording of an element.")],
    part: Measuring,
    how: ReadingOptions,
    *,
    output: Output,
) -> None:
    """Fit the curve of an element to a recording, and list its phases.

    The noise is estimated, and no phase is made by white noise. Travel before contact is left out.
    The result contains phases, friction, noise and error band. With --out, a design file, the curve
    as CSV and a figure are written into a folder.

    Example: stepwell lab element clip.csv --out clip
    """
    output.check_output_folder("lab element")
    given = how.recordings([file], tuple(Measure))
    if len(given) != 1:
        raise wrong(str(file), f"holds {len(given)} recordings: give one file, and --sample.")
    result = part.measured(given[0])
    output.report(result, sw.files.dumps(result.chain), data_sha256=sw.lab.hashes(given))


class FittedPart(Group):
    """The part of tension tests that is fitted."""

    window: str | None = opts.option(
        "Stroke range of the fit [mm], where the band is used; by default the whole test.",
        "--window FROM:TO",
    )
    cycles: str | None = opts.option(
        "Cycles of the fit, counted from 1; by default 5:9, or all but the first.",
        "--fit-cycles FROM:TO",
    )
    drop: list[int] | None = opts.option("Sample to exclude. May be repeated.", "SAMPLE")
    cycles_per_sample: int | None = opts.option(
        "Number of consecutive files per sample, if file names are only numbers.", "N", min=1
    )

    def test(self, recordings: list[Recording]) -> BandTest:
        """This part of the recordings of a tension test."""
        edges = None if self.window is None else read_window(self.window)
        counted = None if self.cycles is None else read_window(self.cycles, whole=True)
        return sw.lab.band_test(
            recordings,
            window=None if edges is None else (edges[0] * 1e-3, edges[1] * 1e-3),
            cycles=None if counted is None else (int(counted[0]), int(counted[1])),
            drop=self.drop or (),
            cycles_per_sample=self.cycles_per_sample,
        )


@opts.command(commands, ReadingCommand)
def band(
    *,
    folders: list[Path] = opts.argument(
        "Tension tests of bands, folders or files: of a machine, or of a scale and a ruler.",
        "PATH...",
    ),
    part: FittedPart,
    how: ReadingOptions,
    gauge: float | None = opts.option(
        "Length of the band at stroke 0, if known [mm].", "--gauge LENGTH", parser=length(-math.inf)
    ),
    law: str | None = opts.option(
        "Force law: write this one instead of the one that is selected automatically.", "NAME"
    ),
    output: Output,
) -> None:
    """Fit the stiffness of bands, and write a `band` table for a design file.

    The result contains the stiffness with its uncertainty, its dependence on the window, the energy
    dissipated in a cycle, and the best force law. A table of lengths and weights is sufficient,
    with columns such as length (mm), weight (g). A law that is wrong somewhere on the test by more
    than its own error is reported, with the strokes on which it holds. With --out, the table, the
    numbers and a figure are written into a folder.

    Example: stepwell lab band recordings --window 5:35
    """
    output.check_output_folder("lab band")
    known = [one.name for one in sw.lab.LAWS]
    # Before the fit, which takes long.
    if law is not None and law not in known:
        raise wrong("--law", f"{law!r}: must be one of {', '.join(known)}.")
    given = how.recordings(folders)
    test = part.test(given)
    with usable("--gauge"), progress("fits"):
        choice = sw.lab.choose_law(test, None if gauge is None else gauge * 1e-3)
    with usable("--law"):
        fit = sw.lab.fit_bands(test, choice, law)
    source = ", ".join(folder.name for folder in folders)
    output.report(fit, source=source, data_sha256=sw.lab.hashes(given))


_Data = Annotated[
    Path,
    typer.Argument(
        metavar="DATA", help="Folder of recordings, searched recursively, or one recording."
    ),
]


class BaselineOptions(Group):
    """The friction that is subtracted."""

    baseline: Path | None = opts.option(
        "Recordings without a band; by default those in DATA with `friction` in their name.",
        "--baseline PATH",
    )
    no_baseline: bool = opts.flag("Do not subtract the friction baseline.", "--no-baseline")

    def read(self, how: ReadingOptions) -> list[Recording] | None:
        """The recordings to subtract: those given, none, or None to select them by name."""
        if self.baseline is not None and self.no_baseline:
            raise wrong("--baseline", "cannot be combined with --no-baseline.")
        if self.no_baseline:
            return []
        return None if self.baseline is None else how.recordings([self.baseline])


class RigOptions(Group):
    """The rig of a test machine."""

    bar: float | None = opts.option(
        "Length of the bar of the rig [mm], inf for none; 70 by default.",
        "--bar LENGTH",
        parser=length(20),
    )
    rig: Path | None = opts.option(
        "Rig file from `stepwell lab calibrate`; it sets how the rig shows snaps of a pair.", "FILE"
    )

    def read(self) -> Rig:
        """The rig of a file, or the paper's rig with another bar."""
        if self.rig is not None:
            if self.bar is not None:
                raise wrong("--rig", "cannot be combined with --bar: FILE has bar_mm.")
            return sw.files.loads_rig(sw.files.text_of(self.rig), str(self.rig))
        return sw.lab.PAPER_RIG if self.bar is None else sw.lab.Rig(self.bar * 1e-3)


@opts.command(commands, ReadingCommand)
def compare(
    data: _Data,
    designs: list[str] | None = opts.argument(
        "Designs that were tested, or parameters that file names leave open; the paper's cell by "
        "default.",
        "[DESIGN]...",
        default=None,
        autocompletion=design_names,
    ),
    as_designed: bool = opts.flag(
        "Use the design unchanged; ignore parameters in file names.", "--as-designed"
    ),
    *,
    friction: BaselineOptions,
    machine: RigOptions,
    how: ReadingOptions,
    output: Output,
) -> None:
    """Compare recordings of unit cells, pairs and chains with the model.

    Friction is subtracted and repeats are averaged. For a unit cell, class, forces and energy are
    compared; for a pair, the order of its cells and its snaps; for a chain of elements or of more
    cells, force and snaps.
    With --out, verdicts, curves and figures are written into a folder.

    Example: stepwell lab compare recordings --out verdicts
    """
    output.check_output_folder("lab compare")
    given = how.recordings([data])
    names = [opts.by_name(design) or design for design in designs or ()]
    designed = {design: sw.files.text_of(design) for design in names}
    chains = [sw.files.loads(text, design).chain for design, text in designed.items()]
    baseline, rig = friction.read(how), machine.read()
    with progress("comparison"):
        comparison = sw.lab.compare(
            given, chains, baseline=baseline, as_designed=as_designed, rig=rig
        )
    hashes = {design: sw.files.digest(text) for design, text in designed.items()}
    output.report(comparison, data_sha256=sw.lab.hashes(given), designs_sha256=hashes)


@opts.command(commands, ReadingCommand)
def calibrate(
    data: _Data,
    law: str | None = opts.option(
        "Force law: linear, cubic, or the folder of tension tests in DATA; by default the law with "
        "the best predictions.",
        "NAME",
    ),
    *,
    friction: BaselineOptions,
    how: ReadingOptions,
    output: Output,
) -> None:
    """Fit one physical model to the curves of all cells and pairs together.

    The result contains force law and stiffness of the bands, loss during unloading, friction of
    machine and joints, weight, rig, and a cross-validation: forces, orders and snaps of each
    geometry, predicted from the others. Where the data do not identify the law, the tension of the
    bands at the lengths in the data is written instead. With --out, the numbers, a band and a pair
    for design files and a figure are written into a folder.

    Example: stepwell lab calibrate recordings
    """
    output.check_output_folder("lab calibrate")
    given = how.recordings([data])
    baseline = friction.read(how)
    with progress("fits") as tell:
        batch = sw.lab.sort_series(given, baseline=baseline)
        prepared = sw.lab.prepare(batch.series, sw.lab.tension_tables(given), batch.notes)
        calibration = sw.lab.calibrate(prepared, law, progress=tell)
    output.report(calibration, source=data.name, data_sha256=sw.lab.hashes(given))


class BuiltTolerances(given.BandTolerances):
    """Tolerances of a prototype, and the probability of anchors in wrong holes."""

    friction: given.Friction = 0.0
    travel_tolerance: given.TravelTolerance = 5.0

    hole: float = opts.option(
        "Spacing of the holes for anchors [mm].", "--holes LENGTH", default=5.0, parser=length(0.1)
    )
    wrong_hole: float = opts.option(
        "Probability that an anchor is in a hole next to its own [%].",
        "PERCENT",
        default=5.0,
        parser=percent(40),
    )


BUILT = BuiltTolerances(anchor=1.0, stiffness_tolerance=10.0)


class BuildSampling(Group):
    """Number and seed of the sampled prototypes."""

    samples: int = opts.option(given.SAMPLES, "N", default=200, min=100)
    seed: given.Seed = 0


class SeenOptions(Group):
    """Observations of a prototype, with their uncertainty."""

    seen: str | None = opts.option("Observed sequence of states, such as 00>10>11>01>00.", "STATES")
    snaps_loading: str | None = opts.option(
        "Strokes of snaps during loading, separated by commas [mm, mL or deg]; none for no snap.",
        "LIST",
    )
    snaps_unloading: str | None = opts.option(
        "Strokes of snaps during unloading, separated by commas [mm, mL or deg]; none for no snap.",
        "LIST",
    )
    pulls: str | None = opts.option(
        "Forces read during loading, as STROKE:FORCE separated by commas [mm:N, mL:kPa, deg:N mm].",
        "LIST",
    )
    data: Path | None = opts.option(
        "Recordings (one file) of stroke and force [mm, N].", "PATH", exists=True
    )
    ruler: float = opts.option(
        "Standard deviation of a measured stroke [mm, mL or deg].",
        "NUMBER",
        default=1.0,
        parser=length(0.01),
    )
    scale: float | None = opts.option(
        "Standard deviation of a measured force [N, kPa or N mm]; by default 5 % of the extreme "
        "force of the nominal design.",
        "NUMBER",
        min=1e-6,
    )


@opts.command(commands, ReadingCommand)
def as_built(
    design: Design,
    observed: SeenOptions,
    target: str | None = opts.option(
        "Target: a sequence such as 00>10>11>01>00; the cycle of the nominal design by default.",
        "TARGET",
    ),
    within: BuiltTolerances = BUILT,
    *,
    sampling: BuildSampling,
    how: ReadingOptions,
    output: Output,
) -> None:
    """Fit as-built parameters to a prototype, and search the anchors to move.

    Input are observations of one loading and unloading: the sequence of states, strokes of snaps
    read from a ruler, forces read from a scale, or a recording. Prototypes within the tolerances,
    some with an anchor in a wrong hole, are sampled at random and weighted by their likelihood.
    With --out, the as-built design and the corrected design are written into a folder.

    Example: stepwell lab as-built preset:paper-forward --seen '00>01>11>10>00'
    """
    output.check_output_folder("lab as-built")
    text, chain = opts.read_chain(design)
    (_, driven), (_, forced) = (
        display_unit(chain.drive_unit),
        display_unit(chain.measure.force_unit),
    )
    peak = abs(chain.cycle().peak_force)
    with usable("the observations"):
        pulls = _read(observed.pulls, chain)
        if observed.data is not None:
            sw.lab.require_travel(chain, str(observed.data))
            pulls += sw.lab.pulls_of(how.recordings([observed.data])[0], chain.full_stroke)
        seen = sw.lab.Observed(
            observed.seen,
            _strokes(observed.snaps_loading, "--snaps-loading", driven),
            _strokes(observed.snaps_unloading, "--snaps-unloading", driven),
            pulls,
            observed.ruler / driven,
            0.05 * peak if observed.scale is None else observed.scale / forced,
        )
    spread = within.tolerances(chain.measure)
    with usable("the observations"), progress("samples") as tell:
        result = sw.lab.as_built(
            chain,
            seen,
            spread,
            target=target,
            hole=within.hole * 1e-3,
            wrong_hole=within.wrong_hole / 100,
            **vars(sampling),
            progress=tell,
        )
    output.report(result, text, design)


def _strokes(text: str | None, name: str, factor: float) -> tuple[float, ...] | None:
    if text is None:
        return None
    if text.strip() in ("", "none"):
        return ()
    try:
        return tuple(millimetres(one) / factor for one in text.split(","))
    except ValueError:
        raise wrong(
            name, f"{text!r}: must be numbers separated by commas, such as 36.5,38, or none."
        ) from None


def _read(text: str | None, chain: Chain) -> tuple[Pull, ...]:
    if text is None:
        return ()
    stroke, force = (
        display_unit(chain.measure.travel_unit)[1],
        display_unit(chain.measure.force_unit)[1],
    )
    try:
        pairs = [one.split(":") for one in text.split(",")]
        return tuple(sw.lab.Pull(1, millimetres(u) / stroke, float(f) / force) for u, f in pairs)
    except ValueError:
        raise wrong(
            "--pulls", f"{text!r}: must be pairs STROKE:FORCE, such as 10:0.35,20:0.1."
        ) from None
