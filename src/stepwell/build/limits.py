"""Limits of material, bands, machine and actuator, each with the part, the numbers, a way out."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations
from typing import Protocol

import numpy as np

from stepwell.base import ByValue, ReadOnly, to_unit
from stepwell.build.build_file import BuildFile, key_of, mm
from stepwell.build.layouts import Layout
from stepwell.build.loads import band_range, hook_loads, lever_forces
from stepwell.build.part import Hole, Part
from stepwell.statics import Path

# Lengths that differ by less are equal [m]: arcs are chords here.
_EQUAL = 5e-6


@dataclass(frozen=True, slots=True, eq=False)
class ExceededLimit(ByValue):
    """A limit that a build exceeds.

    Attributes:
        check: "anchor", "web", "kerf", "bed", "slack", "stretch", "bearing", "pin", "lever",
            "hook", "travel", "force" or "collision"; of a robot also "actuator", "antenna", "rail",
            "post" or "nose".
        parts: names of the parts, bands or cells.
        value, allowed: what it is and the limit, in `unit` (SI).
        unit: "m", "Pa", "N" or "1".
        problem: one sentence with both numbers.
        advice: one action that removes the finding.
        change: numbers of the build file that remove it, as for `BuildFile.with_lengths`; empty if
            only another design does.
    """

    check: str
    parts: tuple[str, ...]
    value: float
    allowed: float
    unit: str
    problem: str
    advice: str
    change: ReadOnly = field(default_factory=lambda: ReadOnly({}))

    def __str__(self):
        return f"{self.problem} {self.advice}"


class Cut(Protocol):
    """A layout of any mechanism: its flat parts and the build file."""

    @property
    def parts(self) -> tuple[Part, ...]:
        """Flat parts."""
        ...

    @property
    def build_file(self) -> BuildFile:
        """Sizes and material."""
        ...


def findings(layout: Layout, path: Path | None) -> tuple[ExceededLimit, ...]:
    """All limits that a layout exceeds.

    Args:
        layout: the layout.
        path: of a full cycle, for the forces; None if the chain has none, then only the bands and
            the travel are checked.
    """
    found = [
        *_anchors(layout),
        *webs_findings(layout),
        *kerf_findings(layout),
        *bed_findings(layout),
        *_bands(layout),
        *_hooks(layout),
        *_travel(layout, path),
    ]
    if path is not None:
        found += [*_joints(layout, path), *_force(layout, path)]
    return tuple(found)


def mpa(value: float) -> str:
    """A stress [Pa] as a number of megapascals."""
    return f"{to_unit(value, 'MPa'):.3g}"


def setting(layout: Cut, name: str, value: float, unit: str) -> str:
    """A key with its new and its present number, as in lever.width_mm = 9 instead of 8."""
    table, _, own = name.partition("__")
    now = getattr(getattr(layout.build_file, table), own)
    new, old = (f"{to_unit(one, unit):.4g}" for one in (value, now))
    return f"{key_of(table, own)} = {new} instead of {old}"


def rounded_up(value: float, step: float = 1e-4) -> float:
    """The next multiple of `step` above a value, so that printed advice is enough."""
    return math.ceil(value / step - 1e-6) * step


def _anchors(layout: Layout) -> Iterator[ExceededLimit]:
    """Bands whose anchors lie off their blocks for every shift of both."""
    hook, bridge = layout.build_file.hook.diameter, layout.build_file.sheet.bridge
    for plan in layout.cells:
        # Both seats reach as far towards the other block.
        least = -2.0 * (plan.front - hook / 2.0 - bridge)
        for one in plan.bands:
            if one.fits:
                continue
            across = plan.cell.bands[one.number].d[0]
            name = f"band {one.number + 1} of cell {plan.number + 1}"
            short = across < least
            way = (
                f"Use anchors with q_x - p_x of {mm(rounded_up(least))} mm or more."
                if short
                else "Move an anchor by 1 mm or more, away from other hooks of the cell."
            )
            yield ExceededLimit(
                "anchor",
                (name,),
                across,
                least if short else across,
                "m",
                f"{name}: no shift of both anchors puts its hooks on the plates, clear of pins and "
                f"edges; q_x - p_x is {mm(across)} mm.",
                way,
            )


def webs_findings(layout: Cut) -> Iterator[ExceededLimit]:
    """Webs between openings, and between openings and edges, of every part."""
    bridge = layout.build_file.sheet.bridge
    # Parts of one kind with the same openings have one finding.
    seen: set[tuple[str, ...]] = set()
    for part in layout.parts:
        worst = min(webs_of(part), default=None)
        if worst is None or worst[0] >= bridge - _EQUAL:
            continue
        web, first, second = worst
        like = (part.name.partition("-")[0], first, second, mm(web))
        if like in seen:
            continue
        seen.add(like)
        yield ExceededLimit(
            "web",
            (part.name,),
            web,
            bridge,
            "m",
            f"{part.name}: {first} is not on the part, {mm(-web)} mm are beyond its edge."
            if web < 0.0 and second == "the edge"
            else f"{part.name}: the web between {first} and {second} is {mm(web)} mm, and "
            f"sheet.bridge_mm asks for {mm(bridge)}.",
            _web_advice(layout, part, first, second, web),
        )


def webs_of(part: Part) -> Iterator[tuple[float, str, str]]:
    """Width [m] of the web between any two openings, and to the edge, with their names."""
    import shapely

    edge = shapely.LinearRing(part.outline.ring(2e-6))
    plate = shapely.Polygon(edge)
    holes = [(f"hole {hole.name}", hole.centre, hole.diameter / 2.0) for hole in part.holes]
    for name, at, radius in holes:
        away = float(shapely.distance(edge, shapely.Point(at)))
        on_plate = bool(shapely.contains(plate, shapely.Point(at)))
        yield (away if on_plate else -away) - radius, name, "the edge"
    for (name, at, radius), (other, to, its) in combinations(holes, 2):
        yield math.dist(at, to) - radius - its, name, other
    for cutout in part.cutouts:
        slot = shapely.Polygon(cutout.ring(2e-6))
        yield float(shapely.distance(edge, slot)), "the slot", "the edge"
        for name, at, radius in holes:
            yield float(shapely.distance(slot, shapely.Point(at))) - radius, "the slot", name


def _web_advice(layout: Cut, part: Part, first: str, second: str, web: float) -> str:
    bridge = layout.build_file.sheet.bridge
    cells = layout.cells if isinstance(layout, Layout) else ()
    joints = {f"hole {i + 1}{a}": plan for i, plan in enumerate(cells) for a in "ab"}
    plan = joints.get(first) or joints.get(second)
    if "the edge" in (first, second) and plan is not None and not part.name.startswith("lever"):
        need = 2.0 * (bridge - web) / math.cos(plan.cell.limit)
        least = rounded_up(plan.cell.lever + need)
        return (
            f"Use levers of {mm(least)} mm or longer in cell {plan.number + 1} of the design, or a "
            f"smaller limit θc."
        )
    if first.startswith("hole") and second.startswith("hole"):
        return f"Move the anchor {mm(rounded_up(bridge - web))} mm or more off the other hole."
    return f"Use another sheet: sheet.bridge_mm = {mm(max(web, 0.0))} if the material allows it."


def kerf_findings(layout: Cut) -> Iterator[ExceededLimit]:
    """The narrowest opening of all parts: the beam has to fit into it."""
    sheet = layout.build_file.sheet
    kerf = max(sheet.kerf_x, sheet.kerf_y)
    holes = [(hole.diameter, part.name, f"hole {hole.name}") for part, hole in _holes(layout)]
    width = layout.build_file.pin.diameter + layout.build_file.pin.lever_fit
    holes += [(width, part.name, "the slot") for part in layout.parts if part.cutouts]
    least, part, name = min(holes)
    if least > kerf + _EQUAL:
        return
    key = key_of("sheet", "kerf_x" if sheet.kerf_x == kerf else "kerf_y")
    yield ExceededLimit(
        "kerf",
        (part,),
        kerf,
        least,
        "m",
        f"{part}: {name} is {mm(least)} mm wide, and {key} is {mm(kerf)}: the beam is as wide as "
        f"the hole.",
        f"Use a machine with {key} below {mm(least)}, or larger pins and screws; the coupon shows "
        f"the kerf.",
    )


def _holes(layout: Cut) -> Iterator[tuple[Part, Hole]]:
    return ((part, hole) for part in layout.parts for hole in part.holes)


def bed_findings(layout: Cut) -> Iterator[ExceededLimit]:
    """Parts that are larger than the bed of the machine."""
    bed = sorted(layout.build_file.sheet.bed)
    for part in layout.parts:
        x0, y0, x1, y1 = part.outline.bounds
        size = sorted((x1 - x0, y1 - y0))
        if size[0] <= bed[0] + _EQUAL and size[1] <= bed[1] + _EQUAL:
            continue
        far = int(size[1] > bed[1] + _EQUAL)
        yield ExceededLimit(
            "bed",
            (part.name,),
            size[far],
            bed[far],
            "m",
            f"{part.name}: it is {mm(size[1])} x {mm(size[0])} mm, and sheet.bed_mm is "
            f"{mm(bed[1])} x {mm(bed[0])}.",
            f"Use a machine with a bed of {mm(rounded_up(size[1], 1e-3))} x "
            f"{mm(rounded_up(size[0], 1e-3))} mm or more, or cells of less travel.",
        )


def _bands(layout: Layout) -> Iterator[ExceededLimit]:
    most = layout.build_file.band.largest_stretch
    for path in layout.bands:
        cell = layout.cells[path.cell].cell
        band = cell.bands[path.number]
        name = f"band {path.number + 1} of cell {path.cell + 1}"
        reach = band_range(cell, path.number)
        if band.rest_length == 0.0:
            yield ExceededLimit(
                "stretch",
                (name,),
                math.inf,
                most,
                "1",
                f"{name}: its rest length is 0, and a rubber band has one.",
                f"Give it rest_length_mm of {mm(rounded_up(reach.longest / most))} or more.",
            )
            continue
        if reach.longest <= band.rest_length:
            yield ExceededLimit(
                "slack",
                (name,),
                reach.longest,
                band.rest_length,
                "m",
                f"{name}: it is slack at all angles: it reaches {mm(reach.longest)} mm at most, "
                f"and its rest length is {mm(band.rest_length)} mm.",
                f"Use a band with a rest length below {mm(reach.longest)} mm, or anchors further "
                f"apart.",
            )
            continue
        if band.two_sided and reach.shortest < band.rest_length - _EQUAL:
            yield ExceededLimit(
                "stretch",
                (name,),
                reach.shortest / band.rest_length,
                1.0,
                "1",
                f"{name}: it is compressed to {mm(reach.shortest)} mm from a rest length of "
                f"{mm(band.rest_length)} mm, and rubber cannot push.",
                "Set two_sided = false in the design, or use a rest_length_mm of "
                f"{mm(reach.shortest)} or less.",
            )
        stretch = reach.longest / band.rest_length
        if stretch > most * (1.0 + 1e-9):
            yield ExceededLimit(
                "stretch",
                (name,),
                stretch,
                most,
                "1",
                f"{name}: it is stretched to {mm(reach.longest)} mm, {stretch:.3g} times its rest "
                f"length of {mm(band.rest_length)} mm, and band.largest_stretch is {most:.3g}.",
                f"Use bands with a rest length of {mm(rounded_up(reach.longest / most))} mm or "
                f"more, or anchors closer together.",
            )


def _hooks(layout: Layout) -> Iterator[ExceededLimit]:
    """Bearing stress in the plate around a hook, and bending of the hook."""
    build_file = layout.build_file
    thick, width = build_file.sheet.thickness, build_file.hook.diameter
    joints = {(f.block, f.name) for f in layout.fasteners if f.use == "pin" and f.joint}
    for (block, hole), bands in hook_loads(layout).items():
        force = sum(pull for _, pull in bands)
        # About the middle of the top plate.
        arm = sum(
            pull * ((path.low + path.high) / 2.0 - layout.stack.top - thick / 2.0)
            for path, pull in bands
        )
        # A joint's pin is held by both plates, a hook by the top plate alone.
        held = thick if (block, hole) not in joints else layout.stack.roof - layout.stack.bottom
        plate = force / (width * thick) + 6.0 * arm / (width * thick * held)
        bent = 32.0 * (arm + force * thick / 2.0) / (math.pi * width**3)
        for stress, allowed, what, key in (
            (plate, build_file.sheet.strength, "the plate around it", "sheet__strength"),
            (bent, build_file.pin.strength, "the hook", "pin__strength"),
        ):
            if stress <= allowed:
                continue
            yield ExceededLimit(
                "hook",
                (f"block-{block}-top",),
                stress,
                allowed,
                "Pa",
                f"block-{block}-top, hook {hole}: {force:.3g} N of bands make {mpa(stress)} "
                f"MPa in {what}, and {key_of(*key.split('__'))} allows {mpa(allowed)}.",
                f"Use softer bands, of {100.0 * allowed / stress:.3g} % of this stiffness or less.",
            )


def _joints(layout: Layout, path: Path) -> Iterator[ExceededLimit]:
    """Stress in levers, plates and pins from the largest force of a lever in the cycle."""
    build_file = layout.build_file
    pin, thick = build_file.pin.diameter, build_file.sheet.thickness
    hole = pin + build_file.pin.lever_fit
    web = build_file.lever.width - hole
    forces = np.abs(lever_forces(layout, path)).max(axis=(0, 2))
    for plan, force in zip(layout.cells, forces.tolist(), strict=True):
        parts = (f"lever-{plan.number + 1}a", f"lever-{plan.number + 1}b")
        checks = (
            # Pressure of the pin on the lever; each plate carries half.
            ("bearing", force / (pin * thick), build_file.sheet.strength, "the holes"),
            ("lever", force / (web * thick), build_file.sheet.strength, "the webs at the holes"),
            # Double shear.
            ("pin", force / (math.pi / 2.0 * pin**2), build_file.pin.strength, "the pins"),
        )
        for check, stress, allowed, where in checks:
            if stress <= allowed:
                continue
            key = "pin.strength_MPa" if check == "pin" else "sheet.strength_MPa"
            yield ExceededLimit(
                check,
                parts,
                stress,
                allowed,
                "Pa",
                f"{parts[0]}: a force of {force:.3g} N makes {mpa(stress)} MPa in {where}, "
                f"and {key} allows {mpa(allowed)}.",
                f"Use softer bands, of {100.0 * allowed / stress:.3g} % of this stiffness or less.",
            )


def _travel(layout: Layout, path: Path | None) -> Iterator[ExceededLimit]:
    have = layout.build_file.actuator.travel
    need = layout.chain.full_stroke
    if path is not None and layout.chain.actuator_stiffness > 0.0:
        # Behind a spring the actuator goes further than the last block.
        need = max(need, float(np.ptp(path.drive)))
    if need > have * (1.0 + 1e-9):
        least = rounded_up(need, 1e-3)
        yield ExceededLimit(
            "travel",
            ("drive-bar",),
            need,
            have,
            "m",
            f"The full stroke takes {mm(need)} mm of travel, and actuator.travel_mm is {mm(have)}.",
            f"Use an actuator with {setting(layout, 'actuator__travel', least, 'mm')}, or fewer "
            f"or smaller cells.",
            ReadOnly({"actuator__travel": least}),
        )


def _force(layout: Layout, path: Path) -> Iterator[ExceededLimit]:
    have = layout.build_file.actuator.force
    need = abs(path.peak_force)
    if need > have:
        least = rounded_up(need, 0.01)
        yield ExceededLimit(
            "force",
            ("drive-bar",),
            need,
            have,
            "N",
            f"The cycle takes {need:.3g} N, and actuator.force_N is {have:.3g}.",
            f"Use an actuator with {setting(layout, 'actuator__force', least, 'N')}, or softer "
            f"bands.",
            ReadOnly({"actuator__force": least}),
        )
