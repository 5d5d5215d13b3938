"""`stepwell design` and `reprogram`: where anchors go, and how far off they may be."""

import math
import re
from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

import stepwell as sw
from stepwell.base import REACH, from_unit, to_unit
from stepwell.cli import tolerances as given
from stepwell.cli.driving import NewDrive, stiffness_of
from stepwell.cli.options import Design, Group, Output, argument, flag, option, read_chain
from stepwell.cli.ranges import Range, span
from stepwell.cli.screen import answered, progress, report, usable, wrong

if TYPE_CHECKING:
    from stepwell.design import BandType

# Bands that go by a name: k [N/m] and ℓ0 [mm] of the paper's cells, robots and antennas.
BANDS = {"paper": (28.5, 10.0), "robot": (30.0, 10.0), "antennas": (47.0, 22.0)}

FORCE_SCALE, TRAVEL_SCALE = Range(0.5, 2.0), Range(1.0, 1.0)

_Side = Annotated[
    Range | None,
    typer.Option(
        parser=span,
        metavar="FROM:TO",
        help="Where anchors q may be [mm]; for the paper's lever 0:20 and -15:15 by default, for "
        "others in proportion, and for anchors p the mirror image.",
    ),
]


def between(text: str | Range) -> Range:
    """FROM:TO, both above 0; they may be equal."""
    try:
        low, high = map(float, str(text).split(":"))
    except ValueError:
        low = high = math.nan
    if not 0 < low <= high < math.inf:
        raise typer.BadParameter(f"{text!r}: must be FROM:TO, both above 0, as in 0.5:2.")
    return Range(low, high)


_Scale = Annotated[
    Range,
    typer.Option(
        parser=between,
        metavar="FROM:TO",
        help="Of elements: least and largest, times their own; 1:1 leaves them as they are.",
    ),
]


class Free(StrEnum):
    """Which anchors are placed."""

    Q = "q"
    P = "p"
    BOTH = "both"


class Objective(StrEnum):
    """What is made as large as possible."""

    YIELD = "yield"
    WORST = "worst"


class Parts(Group):
    """The parts that a design may have, and where their anchors may be."""

    x: _Side = None
    y: _Side = None
    place: Free = option(
        "Which anchors are placed: q beside p at (-10, 0) mm, p beside q at (10, 0) mm, "
        "or both, each p the mirror image of q.",
        "--free",
        default=Free.Q,
    )
    holes: float | None = option(
        "Anchors only in holes this far apart, from the lower left corner on [mm].", "MM", min=0.01
    )
    bands: list[str] | None = option(
        "A band there is: paper, robot, antennas, or N/m, mm and %, or a design file for "
        "its bands, measured ones too; may be given again.",
        "--band NAME|K:LENGTH[:SPREAD]",
    )
    levers: list[float] | None = option(
        "A lever there is [mm]; may be given again. The paper's by default.", "--lever MM"
    )
    mixed_levers: bool = flag("Cells may have different ones of these levers.", "--mixed-levers")
    elements: list[str] | None = option(
        "An element there is instead of bands: one of the library, or those of a design "
        "file; may be given again.",
        "--element NAME|DESIGN",
    )
    force_scale: _Scale = FORCE_SCALE
    travel_scale: _Scale = TRAVEL_SCALE
    unusual: bool = flag("Sizes far off the levers are meant, and no slip of unit.", "--unusual")

    def allowed(self) -> dict[str, Any]:
        """The same as `design.design` takes it."""
        from stepwell.design import PAPER_LEVER, usual_box

        kinds = [one for text in self.elements or () for one in elements_of(text)]
        if kinds and (self.x or self.y or self.holes or self.bands or self.levers):
            raise wrong(
                "--element",
                "cannot stand with --x, --y, --holes, --band or --lever: elements have no anchors.",
            )
        levers = [from_unit(lever, "mm") for lever in self.levers or ()] or [PAPER_LEVER]
        return {
            "within": None if kinds else self._box(usual_box(max(levers), self.place)),
            "free": self.place.value,
            "elements": kinds,
            "force_scale": (self.force_scale.start, self.force_scale.stop),
            "travel_scale": (self.travel_scale.start, self.travel_scale.stop),
            "holes": None if self.holes is None else from_unit(self.holes, "mm"),
            "bands": [one for text in self.bands or ["paper"] for one in stocks(text)],
            "lever": levers,
            "equal_levers": not self.mixed_levers,
            "unusual": self.unusual,
        }

    def _box(self, usual: Any) -> Any:
        for side, low, high in ((self.x, "left", "right"), (self.y, "bottom", "top")):
            if side:
                ends = {low: from_unit(side.start, "mm"), high: from_unit(side.stop, "mm")}
                usual = replace(usual, **ends)
        return usual


class AimOptions(Group):
    """What is made as large as possible, with which actuator."""

    objective: Objective = option(
        "Make the yield largest, or the distance by which all anchors may be off at once.",
        default=Objective.YIELD,
    )
    force_limit: float | None = option("Largest force of the actuator [N].", "N", min=0)
    drive: NewDrive = None


def design(
    *,
    target: str = argument(
        "A cycle as in '00>10>11>01>00', the states wanted in reach as in 00,10,11, or "
        "all:N for N cells with all their states.",
        "TARGET",
    ),
    parts: Parts,
    aim: AimOptions,
    within: given.DesignTolerances,
    sampling: given.Sampling,
    output: Output,
) -> None:
    """Search anchors for a target sequence or a target set of states.

    You get the anchors, checked by the engine, how many mechanisms built with these
    tolerances will do it, and which two cells go wrong first; or the certificate that nothing
    allowed does it. With --element, you get which element each cell is, and its scales. With
    --out, the design file, a figure of the forces that a cell can have, and the result as JSON
    are written into a folder.

    Example: stepwell design '00>10>11>01>00' --out leg
    """
    from stepwell.design import Impossible, design

    wanted, spread, allowed = wish(target), within.tolerances(), parts.allowed()
    output.check_output_folder("design")
    aims = {
        "objective": aim.objective.value,
        "most_force": math.inf if aim.force_limit is None else aim.force_limit,
        "actuator_stiffness": stiffness_of(aim.drive),
    }
    how = wanted | allowed | aims | vars(sampling)
    try:
        with usable("TARGET", Impossible), progress("design") as tell:
            found = design(**how, tolerances=spread, progress=tell)
    except Impossible as why:
        report(sw.accounts.account(why), output.as_json)
        answered(False)
    else:
        output.report(found)


class Direction(NamedTuple):
    """A direction in the plane of an anchor, of any length."""

    x: float
    y: float


def along(text: str) -> Direction:
    """X:Y, or an angle in degrees from the x axis, as a direction."""
    try:
        parts = [float(part) for part in text.split(":")]
        angle = math.radians(parts[0])
        x, y = parts if len(parts) > 1 else (math.cos(angle), math.sin(angle))
    except (OverflowError, ValueError):
        x = y = math.nan
    if not 0 < math.hypot(x, y) < math.inf:
        raise typer.BadParameter(f"{text!r}: must be X:Y, as in -1:0, or degrees, as in 180.")
    return Direction(x, y)


class Way(Group):
    """The way that the anchor is moved."""

    line: Direction | None = option(
        "The line that the anchor keeps to; anywhere in the plane by default.",
        "--along X:Y|DEGREES",
        parser=along,
    )
    one_way: bool = flag("Only in the sense of --along, not against it.", "--one-way")
    reach: float = option(
        "Farthest that is looked at [mm].", "MM", default=to_unit(REACH, "mm"), min=0.001, max=1e6
    )


def reprogram(
    design: Design,
    by: str = option(
        "The anchor that is moved: a cell's name or number, then .p on its inner block or "
        ".q on its outer one, as in inner.p; or a number of an element, as in "
        "dome.force_scale, dome.travel_scale or dome.friction.",
        "--by ANCHOR|NUMBER",
        default=...,
    ),
    target: str | None = option(
        "The cycle wanted, as in '00>01>11>10>00'; any other than now by default.", "SEQUENCE"
    ),
    *,
    way: Way,
    output: Output,
) -> None:
    """Search the smallest displacement of an anchor for another sequence.

    Or the smallest change of a number of an element.

    You get the displacement, the sequence just past it, and the force that has to push the
    anchor on the way: what an antenna must deliver. With --out, the design past the change,
    the way as CSV and the result as JSON are written into a folder.

    Example: stepwell reprogram preset:paper-forward --by inner.p
    """
    from stepwell.design import reprogram

    if way.one_way and way.line is None:
        raise wrong("--one-way", "needs --along X:Y, the way to go.")
    text, chain = read_chain(design)
    output.check_output_folder("reprogram")
    with usable(design), progress("search") as tell:
        found = reprogram(
            chain,
            target,
            by,
            along=way.line,
            one_way=way.one_way,
            reach=from_unit(way.reach, "mm"),
            progress=tell,
        )
    output.report(found, text, design)
    answered(math.isfinite(found.distance))


def wish(text: str) -> dict[str, Any]:
    """A sequence, a list of states, or all:N, as `design.design` takes it."""
    every = re.fullmatch(r"all:(\d{1,2})", text)
    if every:
        return {"states": "all", "cells": int(every[1])}
    if ">" in text:
        return {"sequence": text}
    if "," in text:
        return {"states": [state.strip() for state in text.split(",")]}
    raise wrong(
        "TARGET",
        f"{text!r}: must be a cycle as in 00>10>11>01>00, states as in 00,10,11, or all:N for "
        f"N cells in all their states (quotes keep > from the shell).",
    )


def elements_of(text: str) -> "tuple[sw.Element, ...]":
    """An element of the library by its name, or the elements of a design file."""
    if text in sw.mechanism.LIBRARY:
        return (sw.mechanism.LIBRARY[text].make(name=text),)
    _, chain = read_chain(text)
    if not chain.elements:
        raise wrong(
            "--element",
            f"{text!r} has no elements: must be a design file that has, or one of "
            f"{', '.join(sw.mechanism.LIBRARY)}.",
        )
    return chain.elements


def stocks(text: str) -> "list[BandType]":
    """What `stock` reads, or the bands of a design file."""
    from stepwell.design import BandType

    if not text.endswith(".toml") and not text.startswith("preset:"):
        return [stock(text)]
    _, chain = read_chain(text)
    cells = [cell for cell in chain.cells if isinstance(cell, sw.Cell)]
    return list(dict.fromkeys(BandType.of(band) for cell in cells for band in cell.bands))


def stock(text: str) -> "BandType":
    """NAME, or K:LENGTH[:SPREAD] in N/m, mm and %."""
    from stepwell.design import BandType

    if text in BANDS:
        k, length = BANDS[text]
        return BandType(k, from_unit(length, "mm"), name=text)
    try:
        k, length, *spread = map(float, text.split(":"))
        (part,) = spread or (None,)
    except ValueError:
        raise wrong(
            "--band",
            f"{text!r}: must be {', '.join(BANDS)}, or K:LENGTH[:SPREAD] in N/m, mm and %, as in "
            f"28.5:10:5, or a design file with bands, as in mine.toml.",
        ) from None
    share = None if part is None else from_unit(part, "percent")
    with usable("--band"):
        return BandType(k, from_unit(length, "mm"), share)
