"""`stepwell design` and `reprogram`: inverse design, and the smallest change of a design."""

import itertools
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

import stepwell as sw
from stepwell.base import REACH, from_unit, to_unit
from stepwell.cli import tolerances as given
from stepwell.cli.driving import NewDrive, stiffness_of
from stepwell.cli.options import (
    Design,
    Group,
    Output,
    Prove,
    argument,
    by_name,
    designs,
    flag,
    option,
    read_chain,
    read_hopper,
)
from stepwell.cli.ranges import Point, Range, by_cell, length, millimetres, point, span
from stepwell.cli.screen import answered, progress, usable, wrong

if TYPE_CHECKING:
    from stepwell.design import BandType, Means

# Bands with a name: k [N/m] and ℓ0 [mm] of the paper's cells, robots and antennas.
BANDS = {"paper": (28.5, 10.0), "robot": (30.0, 10.0), "antennas": (47.0, 22.0)}

# A cell that holds the band of a table without cells.
_ANYWHERE = "[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]\n"

# Words of requirements, which no other target has.
_REQUIREMENTS = re.compile(r"\b(before|first|last|order|state|to|never|after|cells?)\b")

# Targets of a hopper.
TASKS = "jump", "throw", "strike"

FORCE_SCALE, TRAVEL_SCALE = Range(0.5, 2.0), Range(1.0, 1.0)


def _side(axis: str, usual: str) -> Any:
    return option(
        f"Anchor positions: allowed range of q along {axis} [mm]. By default {usual} for the "
        "paper's lever, scaled for other levers, mirrored for p.",
        "FROM:TO",
        parser=span,
    )


def between(text: str | Range) -> Range:
    """FROM:TO, both above 0 and maybe equal."""
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
        help="Range of this scale factor of elements; 1:1 leaves them unchanged.",
    ),
]


class Free(StrEnum):
    """Which anchors are placed."""

    Q = "q"
    P = "p"
    BOTH = "both"


class Objective(StrEnum):
    """The quantity that is maximised."""

    YIELD = "yield"
    WORST = "worst"


class Parts(Group):
    """Available parts, and allowed positions of their anchors."""

    x: Range | None = _side("x", "0:20")
    y: Range | None = _side("y", "-15:15")
    place: Free = option(
        "Anchors to place: q with p at (-10, 0) mm, p with q at (10, 0) mm, or both, with p the "
        "mirror image of q.",
        "--free",
        default=Free.Q,
    )
    holes: float | None = option(
        "Spacing of the holes for anchors [mm].", "LENGTH", parser=length(0.01)
    )
    origin: Point | None = option(
        "A point of the grid of --holes [mm], in the frame of each block; by default 0:0, halfway "
        "between the lever joints.",
        "X:Y",
        parser=point,
    )
    build: str | None = option(
        "Build file (TOML) or its preset, such as acrylic-3mm: its grid of holes replaces --holes, "
        "--origin, and --x and --y unless given.",
        f"--build {given.BUILD_FILE}",
        autocompletion=given.materials,
    )
    bands: list[str] | None = option(
        "Available band: paper, robot or antennas; stiffness [N/m], rest length and tolerance [%]; "
        "or a design file with bands, or band.toml of lab band. With N and x before it, a pack of "
        "N bands, such as 6xpaper. May be repeated.",
        "--band NAME|K:LENGTH[:PERCENT]",
    )
    most_bands: int = option(
        "Maximum number of equal bands in a cell, all between the same anchors.",
        "--most-bands N",
        default=1,
        min=1,
        max=10,
    )
    levers: list[float] | None = option(
        "Available lever length [mm]; the paper's by default. Lengths with commas are those of the "
        "cells, inner cell first. May be repeated.",
        "--lever LENGTH,...",
        parser=by_cell(length()),
    )
    mixed_levers: bool = flag("Allow cells with different levers.", "--mixed-levers")
    elements: list[str] | None = option(
        "Available element in place of bands: a name of the library, or a design file with "
        "elements. May be repeated.",
        "--element NAME|DESIGN",
    )
    force_scale: _Scale = FORCE_SCALE
    travel_scale: _Scale = TRAVEL_SCALE
    unusual: bool = flag("Accept lengths that look like unit errors.", "--unusual")

    def allowed(self) -> dict[str, Any]:
        """Keyword arguments of `design.design`."""
        from stepwell.design import PAPER_LEVER, usual_box

        kinds = [*itertools.chain.from_iterable(map(elements_of, self.elements or ()))]
        self._refuse_combinations(kinds)
        levers = [given.in_si(lever, "mm") for lever in self.levers or ()] or [PAPER_LEVER]
        longest = max(max(one) if isinstance(one, tuple) else one for one in levers)
        usual, holes = usual_box(longest, self.place), self.holes
        box = self._box(usual) if self.x or self.y else None
        if self.build is not None:
            grid = self._grid(self.build)
            holes, box = to_unit(grid.pitch, "mm"), self._box(self._reach(grid, usual))
        return {
            "within": box,
            "free": self.place.value,
            "elements": kinds,
            "force_scale": (self.force_scale.start, self.force_scale.stop),
            "travel_scale": (self.travel_scale.start, self.travel_scale.stop),
            "holes": None if holes is None else from_unit(holes, "mm"),
            "origin": tuple(from_unit(one, "mm") for one in self.origin or (0.0, 0.0)),
            "bands": [*itertools.chain.from_iterable(map(packs_of, self.bands or ["paper"]))],
            "most_bands": self.most_bands,
            "lever": levers,
            "equal_levers": not self.mixed_levers,
            "unusual": self.unusual,
        }

    def refuse_for_jumps(self) -> None:
        """Refuse options that have no meaning for a jump."""
        unused = {"--x": self.x, "--y": self.y, "--origin": self.origin, "--element": self.elements}
        unused |= {"--most-bands": self.most_bands > 1}
        unused |= {"--mixed-levers": self.mixed_levers, "--free": self.place is not Free.Q}
        unused |= {"--force-scale": self.force_scale != FORCE_SCALE}
        unused |= {"--travel-scale": self.travel_scale != TRAVEL_SCALE}
        _refuse_given(unused)
        if len(self.levers or ()) > 1 or any(isinstance(one, tuple) for one in self.levers or ()):
            raise wrong("--lever", "must be one length for a jump.")

    def means(self, usual: "Means") -> "Means":
        """The grid of holes in place of the usual one."""
        if self.build is not None:
            grid = self._grid(self.build)
            return usual._replace(pitch=grid.pitch, depth=grid.depth, side=grid.side)
        return usual if self.holes is None else usual._replace(pitch=from_unit(self.holes, "mm"))

    def _reach(self, grid: Any, usual: Any) -> Any:
        """The box of anchors on the grid of a build file."""
        left, right = (-grid.depth, 0.0) if self.place is Free.P else (0.0, grid.depth)
        return replace(usual, left=left, right=right, bottom=-grid.side, top=grid.side)

    def _grid(self, build: str) -> Any:
        """The grid of holes of a build file."""
        from stepwell.build import load_build_file

        if self.holes or self.origin or self.elements:
            raise wrong("--build", "cannot be combined with --holes, --origin or --element.")
        with usable("--build"):
            return load_build_file(build).grid

    def _refuse_combinations(self, kinds: list[Any]) -> None:
        if kinds and (self.x or self.y or self.holes or self.bands or self.levers):
            raise wrong(
                "--element",
                "cannot be combined with --x, --y, --holes, --band or --lever: elements have no "
                "anchors.",
            )
        if self.origin and not self.holes:
            raise wrong("--origin", "needs --holes LENGTH, the spacing of the grid.")

    def _box(self, usual: Any) -> Any:
        for side, low, high in ((self.x, "left", "right"), (self.y, "bottom", "top")):
            if side:
                ends = {low: from_unit(side.start, "mm"), high: from_unit(side.stop, "mm")}
                usual = replace(usual, **ends)
        return usual


class AimOptions(Group):
    """The objective, and the actuator."""

    objective: Objective = option(
        "Quantity to maximise: the yield, or the worst-case margin of all anchors together.",
        default=Objective.YIELD,
    )
    weights: list[str] | None = option(
        "Weight of yield, peak-force, snap-energy or window in the choice between candidates. May "
        "be repeated.",
        "--weight NAME=NUMBER",
    )
    force_limit: float | None = option("Maximum force of the actuator [N].", "FORCE", min=0)
    drive: NewDrive = None
    actuators: int = option(
        "Number of actuators. With 2, one of them holds a block between two cells, and TARGET is a "
        "list of states such as '00>10>00>01>00'; each step moves one cell.",
        default=1,
        min=1,
        max=2,
    )
    hopper: str | None = option(
        "Jump, throw or strike: design file with a table [hopper] of masses, actuator and stretch; "
        "the preset hopper by default.",
        "--hopper DESIGN",
        autocompletion=designs,
        callback=by_name,
    )
    stretch: float | None = option(
        "Jump, throw or strike: maximum length of a band over its rest length.",
        "--stretch RATIO",
        min=1,
    )

    def refuse_for_jumps(self) -> None:
        """Refuse options that have no meaning for a jump."""
        unused = {"--weight": self.weights, "--drive": self.drive}
        unused |= {"--actuators": self.actuators > 1}
        _refuse_given(unused | {"--objective": self.objective is not Objective.YIELD})

    def refuse_for_two(self, prove: bool) -> None:
        """Refuse options that have no meaning for two actuators."""
        for name, value in {"--drive": self.drive, "--prove": prove}.items():
            if value:
                raise wrong(name, "cannot be combined with --actuators 2.")


def _refuse_given(options: dict[str, Any]) -> None:
    """Refuse options that were given although the target is a jump, a throw or a strike."""
    for name, value in options.items():
        if value:
            raise wrong(name, "cannot be combined with jump, throw or strike.")


def design(
    *,
    target: str = argument(
        "Target: a sequence such as '00>10>11>01>00', an order of loading and unloading such as "
        "2-1-3/1-2-3 or of loading alone such as 2-1-3, reachable states such as 00,10,11, all:N "
        "for all states of N cells, or requirements such as '2 before 1 loading; state 101'; or "
        "jump, throw or strike, for the most energy in one snap.",
        "TARGET",
    ),
    parts: Parts,
    aim: AimOptions,
    within: given.DesignTolerances,
    sampling: given.Sampling,
    prove: Prove = False,
    output: Output,
) -> None:
    """Search anchors for a target sequence or a target set of states.

    The result contains the anchors, verified by simulation, the yield within the tolerances, and
    the pair of cells that fails first; or the proof that no allowed design reaches the target. With
    --element, the result contains the element of each cell and its scale factors. With --out, the
    design file, a figure of the feasible critical forces and the result as JSON are written into a
    folder.

    With the target jump, throw or strike, the result is a hopper: the pair of cells whose snap sets
    the most energy free, its yield, and a proved bound.

    Example: stepwell design '00>10>11>01>00' --out leg
    """
    from stepwell.design import Impossible, design, design_tapped

    if target in TASKS:
        _design_jump(target, parts, aim, within, sampling, output)
        return
    if aim.hopper is not None or aim.stretch is not None:
        raise wrong(
            "--hopper" if aim.hopper else "--stretch", f"needs TARGET {' or '.join(TASKS)}."
        )
    goal = {} if aim.actuators > 1 else target_of(target)
    spread, allowed = within.tolerances(), parts.allowed()
    output.check_output_folder("design")
    aims = {
        "objective": aim.objective.value,
        "most_force": math.inf if aim.force_limit is None else aim.force_limit,
        "actuator_stiffness": stiffness_of(aim.drive),
        "weights": weights_of(aim.weights or ()),
    }
    how: dict[str, Any] = goal | allowed | aims | vars(sampling) | {"tolerances": spread}
    if aim.actuators > 1:
        aim.refuse_for_two(prove)
        _report(lambda tell: design_tapped(target, progress=tell, **how), output)
        return
    try:
        with usable("TARGET", Impossible), progress("design") as tell:
            result = design(**how, progress=tell)
        if prove:
            with usable("--prove"), progress("proof") as tell:
                result = result.prove(tell)
    except Impossible as why:
        if prove:
            with usable("--prove"), progress("proof") as tell:
                why = why.prove(tell)
        replace(output, out=None).report(why)
        answered(False)
    else:
        output.report(result)


def _report(search: Any, output: Output, name: str = "TARGET") -> None:
    """The design that a search returns, or the reason why there is none."""
    from stepwell.design import Impossible

    try:
        with usable(name, Impossible), progress("design") as tell:
            made = search(tell)
    except Impossible as why:
        replace(output, out=None).report(why)
        answered(False)
    else:
        output.report(made)


def _design_jump(
    task: str,
    parts: Parts,
    aim: AimOptions,
    within: given.DesignTolerances,
    sampling: given.Sampling,
    output: Output,
) -> None:
    """The hopper with the strongest snap, or the reason why there is none."""
    from stepwell.robot import Task, design_jump, usual_means

    parts.refuse_for_jumps()
    aim.refuse_for_jumps()
    name = aim.hopper or "preset:hopper"
    _, hopper = read_hopper(name)
    output.check_output_folder("design")
    levers = [from_unit(one, "mm") for one in parts.levers or ()]
    lever = levers[0] if levers else hopper.chain.levers[0].lever
    means = parts.means(usual_means(hopper, lever))
    if aim.stretch is not None:
        means = means._replace(stretch=aim.stretch)
    if aim.force_limit is not None:
        means = means._replace(force=aim.force_limit)
    bands = [one for text in parts.bands or () for one in bands_of(text)]
    how = {"lever": lever, "sampling": (sampling.samples, sampling.seed)}
    hopper = replace(hopper, task=Task(task))
    how |= {"tolerances": within.tolerances()}
    _report(lambda _tell: design_jump(hopper, bands, means, **how), output, name)


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
    """Allowed displacements of the anchor."""

    line: Direction | None = option(
        "Direction of the displacement; any direction in the plane by default.",
        "--along X:Y|DEGREES",
        parser=along,
    )
    one_way: bool = flag("Exclude displacements opposite to --along.", "--one-way")
    reach: float = option(
        "Maximum displacement [mm].",
        "LENGTH",
        default=to_unit(REACH, "mm"),
        parser=length(0.001, 1e6),
    )


def reprogram(
    design: Design,
    by: str = option(
        "Parameter to change: an anchor as CELL.p (on the inner block) or CELL.q (on the outer "
        "block), with the name or number of the cell, such as inner.p; or a number of an element, "
        "such as dome.force_scale, dome.travel_scale or dome.friction.",
        "--by ANCHOR|NUMBER",
        default=...,
    ),
    target: str | None = option(
        "Target: a sequence such as '00>01>11>10>00'; any other sequence by default.", "TARGET"
    ),
    *,
    way: Way,
    output: Output,
) -> None:
    """Search the smallest displacement of an anchor for another sequence.

    For an element, the smallest change of one of its numbers is searched.

    The result contains the displacement, the sequence after it, and the force on the anchor during
    the displacement, which an antenna must supply. With --out, the changed design, the displacement
    as CSV and the result as JSON are written into a folder.

    Example: stepwell reprogram preset:paper-forward --by inner.p
    """
    from stepwell.design import reprogram

    if way.one_way and way.line is None:
        raise wrong("--one-way", "needs --along X:Y, the direction.")
    text, chain = read_chain(design)
    output.check_output_folder("reprogram")
    with usable(design), progress("search") as tell:
        result = reprogram(
            chain,
            target,
            by,
            along=way.line,
            one_way=way.one_way,
            reach=from_unit(way.reach, "mm"),
            progress=tell,
        )
    output.report(result, text, design)
    answered(math.isfinite(result.distance))


def target_of(text: str) -> dict[str, Any]:
    """A sequence, a list of states, or all:N, as keyword arguments of `design.design`."""
    every = re.fullmatch(r"all:(\d{1,2})", text)
    if every:
        return {"states": "all", "cells": int(every[1])}
    if _REQUIREMENTS.search(text):
        return {"requirements": text}
    if ">" in text or "-" in text or re.search(",.*[2-9]|[2-9].*,", text):
        return {"sequence": text if ">" in text else text.replace(",", "-")}
    if "," in text:
        return {"states": [state.strip() for state in text.split(",")]}
    raise wrong(
        "TARGET",
        f"{text!r}: must be a sequence such as 00>10>11>01>00, an order such as 2-1-3 or "
        f"2-1-3/1-2-3, states such as 00,10,11, all:N for all states of N cells, or requirements "
        f"such as '2 before 1 loading; state 101'. Put a sequence in quotes, for the shell "
        f"interprets >.",
    )


def weights_of(texts: Iterable[str]) -> dict[str, float] | None:
    """NAME=NUMBER of each weight; None without any."""
    weights: dict[str, float] = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            weights[name.replace("-", " ")] = float(number)
        except ValueError:
            raise wrong("--weight", f"{text!r}: must be NAME=NUMBER, as in window=1.") from None
    return weights or None


def elements_of(text: str) -> "tuple[sw.Element, ...]":
    """The element of the library with this name, or the elements of a design file."""
    if text in sw.mechanism.LIBRARY:
        return (sw.mechanism.LIBRARY[text].make(name=text),)
    _, chain = read_chain(text)
    if not chain.elements:
        raise wrong(
            "--element",
            f"{text!r} has no elements: must be a design file with elements, or one of "
            f"{', '.join(sw.mechanism.LIBRARY)}.",
        )
    return chain.elements


def packs_of(text: str) -> "list[BandType]":
    """The bands that `bands_of` reads, of which N are available after N and x."""
    pack = re.match(r"(\d+)x", text)
    if pack is None:
        return bands_of(text)
    with usable("--band"):
        return [replace(one, pack=int(pack[1])) for one in bands_of(text[pack.end() :])]


def bands_of(text: str) -> "list[BandType]":
    """The band that `band_of` reads, or the bands of a design file or of a `lab band` table."""
    from stepwell.design import BandType

    if not text.endswith(".toml") and not (by_name(text) or "").startswith("preset:"):
        return [band_of(text)]
    given = sw.files.text_of(by_name(text) or text)
    if re.search(r"(?m)^band *=", given) and not re.search(r"(?m)^\[", given):
        given = f"[chain]\nunusual = true\n{given}\n{_ANYWHERE}"
    chain = sw.files.loads(given, text).chain
    cells = [cell for cell in chain.cells if isinstance(cell, sw.Cell)]
    return list(dict.fromkeys(BandType.of(band) for cell in cells for band in cell.bands))


def band_of(text: str) -> "BandType":
    """NAME, or K:LENGTH[:PERCENT] with K in N/m."""
    from stepwell.design import BandType

    if text in BANDS:
        k, rest_mm = BANDS[text]
        return BandType(k, from_unit(rest_mm, "mm"), name=text)
    try:
        k, rest_length, *percents = text.split(":")
        stiffness, rest = float(k), from_unit(millimetres(rest_length), "mm")
        (percent,) = map(float, percents or ("nan",))
    except ValueError:
        raise wrong(
            "--band",
            f"{text!r}: must be {', '.join(BANDS)}, or K:LENGTH[:PERCENT] in N/m, mm and %, such "
            f"as 28.5:10:5, or a design file with bands, such as mine.toml; for a pack, with a "
            f"whole number of bands and x before it, such as 6xpaper.",
        ) from None
    tolerance = from_unit(percent, "percent") if percents else None
    with usable("--band"):
        return BandType(stiffness, rest, tolerance)
