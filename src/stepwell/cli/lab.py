"""`stepwell lab`: recordings in, calibrated bands, comparisons and as-built parameters out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import stepwell as sw
from stepwell.base import display_unit
from stepwell.cli import tolerances as given
from stepwell.cli.options import Design, Group, Output, argument, command, flag, option, read_chain
from stepwell.cli.ranges import window as read_window
from stepwell.cli.screen import WRONG_INPUT, progress, subcommands, usable, wrong
from stepwell.cli.tolerances import recordings_in

if TYPE_CHECKING:
    from stepwell.lab import BandTest, Pull, Recording, Rig
    from stepwell.mechanism import Chain


commands = subcommands("Read recordings of a test machine, fit bands, and compare with the model.")


@command(commands)
def read(
    *,
    files: list[Path] = argument(
        "Recordings or folders of them: Bluehill raw data as text, or CSV with named columns.",
        "FILE...",
    ),
    output: Output,
) -> None:
    """List what recordings hold: samples, cycles, columns and units.

    A file that is broken, empty, binary or in an unknown unit gets one line, and stops no other.
    With --out, all samples are written into a folder as one tidy table with units.

    Example: stepwell lab read recordings --out tidy
    """
    output.check_output_folder("lab read")
    with progress("reading") as tell:
        batch = sw.lab.read_all(files, progress=tell)
    if not batch.recordings:
        output = replace(output, out=None)
    output.report(batch)
    if not batch.recordings:
        raise typer.Exit(WRONG_INPUT)


class FittedPart(Group):
    """Which part of tension tests is fitted."""

    window: str | None = option(
        "Stroke between which bands are fitted; 5:35 where it is measured, else all.",
        "--window-mm FROM:TO",
    )
    cycles: str | None = option(
        "Cycles that are fitted, from 1; 5:9 where there are any, else all later than 1.", "FROM:TO"
    )
    drop: list[int] | None = option("A sample to leave out; may be given again.", "SAMPLE")
    cycles_per_sample: int | None = option(
        "How many files in a row are of one sample, where names only count.", "N", min=1
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


@command(commands)
def band(
    *,
    folders: list[Path] = argument(
        "Tension tests of bands, folders or files, by a machine or a scale and a ruler.", "PATH..."
    ),
    part: FittedPart,
    gauge: float | None = option(
        "Length of the band at stroke 0, if you know it.", "--gauge-mm LENGTH"
    ),
    law: str | None = option("The law to write, whatever is chosen.", "NAME"),
    output: Output,
) -> None:
    """Fit the stiffness of bands, and write a `band` table for a design file.

    Stiffness with its uncertainty, its dependence on the window, the work lost in a cycle, and the
    force law that explains it best. A table of lengths and weights is enough, such as
    length (mm), weight (g). The defaults for window and cycles are the paper's.
    With --out, the table, the numbers and a figure are written into a folder.

    Example: stepwell lab band recordings --window-mm 5:35
    """
    output.check_output_folder("lab band")
    known = [one.name for one in sw.lab.LAWS]
    # Before all of them are fitted.
    if law is not None and law not in known:
        raise wrong("--law", f"{law!r}: must be one of {', '.join(known)}.")
    given = recordings_in(folders)
    test = part.test(given)
    with usable("--gauge-mm"):
        choice = sw.lab.choose_law(test, None if gauge is None else gauge * 1e-3)
    with usable("--law"):
        found = sw.lab.fit_bands(test, choice, law)
    source = ", ".join(folder.name for folder in folders)
    output.report(found, source=source, data_sha256=sw.lab.hashes(given))


_Data = Annotated[
    Path,
    typer.Argument(metavar="DATA", help="A folder of recordings, at any depth, or one recording."),
]


class BaselineOptions(Group):
    """Which friction is subtracted."""

    baseline: Path | None = option(
        "Runs without a band; by default those in DATA whose name says friction.", "--baseline PATH"
    )
    no_baseline: bool = flag("Subtract no friction, whatever is there.", "--no-baseline")

    def read(self) -> list[Recording] | None:
        """The runs to subtract: those given, none, or None where names decide."""
        if self.baseline is not None and self.no_baseline:
            raise wrong("--baseline", "cannot stand with --no-baseline.")
        if self.no_baseline:
            return []
        return None if self.baseline is None else recordings_in([self.baseline])


class RigOptions(Group):
    """The rig of a test machine."""

    bar: float | None = option(
        "Bar of the rig, inf for none; 70 if not said.", "--bar-mm LENGTH", min=20
    )
    rig: Path | None = option(
        "The rig that `stepwell lab calibrate` found: where it shows a snap of a pair.", "FILE"
    )

    def read(self) -> Rig:
        """The rig of a file, or the paper's with another bar."""
        if self.rig is not None:
            if self.bar is not None:
                raise wrong("--rig", "cannot stand with --bar-mm: FILE has bar_mm.")
            return sw.files.loads_rig(sw.files.text_of(self.rig), str(self.rig))
        return sw.lab.PAPER_RIG if self.bar is None else sw.lab.Rig(self.bar * 1e-3)


@command(commands)
def compare(
    data: _Data,
    designs: list[str] | None = argument(
        "What was tested, or what file names leave open; the paper's cell by default.",
        "[DESIGN]...",
        default=None,
    ),
    as_designed: bool = flag("Take the design as it is, whatever file names say.", "--as-designed"),
    *,
    friction: BaselineOptions,
    machine: RigOptions,
    output: Output,
) -> None:
    """Compare unit cells and pairs on a test machine with their models.

    Friction is subtracted and repeats are averaged. A unit cell gets its class, its forces and its
    energy judged, a pair the order of its cells and its snaps.
    With --out, verdicts, curves and figures are written into a folder.

    Example: stepwell lab compare recordings --out verdicts
    """
    output.check_output_folder("lab compare")
    given = recordings_in([data])
    designed = {design: sw.files.text_of(design) for design in designs or ()}
    comparison = sw.lab.compare(
        given,
        [sw.files.loads(text, design).chain for design, text in designed.items()],
        baseline=friction.read(),
        as_designed=as_designed,
        rig=machine.read(),
    )
    hashes = {design: sw.files.digest(text) for design, text in designed.items()}
    output.report(comparison, data_sha256=sw.lab.hashes(given), designs_sha256=hashes)


@command(commands)
def calibrate(
    data: _Data,
    law: str | None = option(
        "linear, cubic, or tension tests in DATA by their folder; by default the law that "
        "predicts best.",
        "NAME",
    ),
    *,
    friction: BaselineOptions,
    output: Output,
) -> None:
    """Fit one physical model to the curves of all cells at once, single and in pairs.

    Law and stiffness of the bands, loss on the way back, friction of machine and joints, weight and
    rig, with what is predicted of each geometry from the others: forces, orders, snaps.
    With --out, the numbers, a band and a pair for design files and a figure go into a folder.

    Example: stepwell lab calibrate recordings
    """
    output.check_output_folder("lab calibrate")
    given = recordings_in([data])
    found = sw.lab.sort_series(given, baseline=friction.read())
    prepared = sw.lab.prepare(found.series, sw.lab.tension_tables(given), found.told)
    with progress("fits") as tell:
        calibration = sw.lab.calibrate(prepared, law, progress=tell)
    output.report(calibration, source=data.name, data_sha256=sw.lab.hashes(given))


_Strokes = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Strokes where it snapped that way, with commas [mm, mL or deg]; none for no snap.",
    ),
]


class BuiltTolerances(given.BandTolerances):
    """The tolerances of a first build, and how likely its anchors are in wrong holes."""

    friction: given.Friction = 0.0
    travel_tolerance: given.TravelTolerance = 5.0

    hole: float = option("How far apart holes are.", "--hole-mm MM", default=5.0, min=0.1)
    wrong_hole: float = option(
        "How likely an anchor is in the hole beside its own.", "PERCENT", default=5.0, min=0, max=40
    )


BUILT = BuiltTolerances(anchor=1.0, stiffness_tolerance=10.0)


class BuildSampling(Group):
    """How many first builds are drawn, and which."""

    samples: int = option("How many builds are drawn.", "N", default=200, min=100)
    seed: given.Seed = 0


class SeenOptions(Group):
    """What was seen of a first build, and how surely."""

    seen: str | None = option("The states it went through, as 00>10>11>01>00.", "STATES")
    snaps_out: _Strokes = None
    snaps_back: _Strokes = None
    pulls: str | None = option(
        "Forces read on the way out, STROKE:FORCE with commas [mm:N, mL:kPa, deg:N mm].", "LIST"
    )
    data: Path | None = option("A recording of stroke and force [mm, N].", "FILE", exists=True)
    ruler: float = option(
        "Standard deviation of a stroke [mm, mL or deg].", "DOUBT", default=1.0, min=0.01
    )
    scale: float | None = option(
        "Standard deviation of a force [N, kPa or N mm]; 5 % of the drawing's peak force.",
        "DOUBT",
        min=1e-6,
    )


@command(commands)
def as_built(
    design: Design,
    observed: SeenOptions,
    target: str | None = option("What it should do; by default what the drawing does.", "STATES"),
    within: BuiltTolerances = BUILT,
    *,
    sampling: BuildSampling,
    output: Output,
) -> None:
    """Fit as-built parameters to a first build, and search which anchors to move.

    Give what you saw when it was pulled out and let back once: the order of its states, strokes of
    snaps read off a ruler, forces read off a scale, or a recording. Builds within tolerances, some
    with an anchor in a wrong hole, are drawn at random and weighed by how well they agree with it.
    With --out, the design as it was built and as it is with the best move go into a folder.

    Example: stepwell lab as-built preset:paper-forward --seen '00>01>11>10>00'
    """
    output.check_output_folder("lab as-built")
    text, chain = read_chain(design)
    (_, driven), (_, forced) = (
        display_unit(chain.drive_unit),
        display_unit(chain.measure.force_unit),
    )
    peak = abs(chain.cycle().peak_force)
    with usable("what was seen"):
        pulls = _read(observed.pulls, chain)
        if observed.data is not None:
            pulls += sw.lab.pulls_of(sw.lab.read(observed.data), chain.full_stroke)
        seen = sw.lab.Observed(
            observed.seen,
            _strokes(observed.snaps_out, "--snaps-out", driven),
            _strokes(observed.snaps_back, "--snaps-back", driven),
            pulls,
            observed.ruler / driven,
            0.05 * peak if observed.scale is None else observed.scale / forced,
        )
    spread = within.tolerances(chain.measure)
    with usable("what was seen"), progress("builds") as tell:
        found = sw.lab.as_built(
            chain,
            seen,
            spread,
            target=target,
            hole=within.hole * 1e-3,
            wrong_hole=within.wrong_hole / 100,
            **vars(sampling),
            progress=tell,
        )
    output.report(found, text, design)


def _strokes(text: str | None, option: str, factor: float) -> tuple[float, ...] | None:
    if text is None:
        return None
    if text.strip() in ("", "none"):
        return ()
    try:
        return tuple(float(one) / factor for one in text.split(","))
    except ValueError:
        raise wrong(
            option, f"{text!r}: must be numbers with commas, as 36.5,38, or none."
        ) from None


def _read(text: str | None, chain: Chain) -> tuple[Pull, ...]:
    if text is None:
        return ()
    stroke, force = (
        display_unit(chain.measure.travel_unit)[1],
        display_unit(chain.measure.force_unit)[1],
    )
    try:
        pairs = [tuple(map(float, one.split(":"))) for one in text.split(",")]
        return tuple(sw.lab.Pull(1, u / stroke, f / force) for u, f in pairs)
    except ValueError:
        raise wrong(
            "--pulls", f"{text!r}: must be STROKE:FORCE with commas, as 10:0.35,20:0.1."
        ) from None
