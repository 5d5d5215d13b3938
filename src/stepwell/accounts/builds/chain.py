"""A build: whether its parts can be made, what they weigh, what to buy, and the yield."""

from collections import Counter
from collections.abc import Callable
from operator import itemgetter
from typing import Any

from stepwell import base
from stepwell.accounts import yields
from stepwell.accounts.head import About, DesignShape, keys, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Notes, Picture, RecordTable, Sections
from stepwell.accounts.words import assumed, cells_of
from stepwell.base import Quantity, Schema, amount, counted, number
from stepwell.build import (
    BandUse,
    Build,
    Clearance,
    ExceededLimit,
    Layout,
    MotionSweep,
    Part,
    RobotBuild,
    RobotLayout,
)


def build_schema(shape: DesignShape) -> Schema:
    """What is reported of a build."""
    sampled = yields.inner_yield_schema(shape)
    return (
        *yields.CHAIN,
        *keys(can_be_built=bool, build_file=(str, "build_file.title")),
        *base.read_off(keys(material=str, thickness="mm"), "build_file.sheet"),
        *keys(mass="g", fastener_mass="g", stroke=("mm", "chain.full_stroke")),
        Quantity("peak_force", "N", read=lambda made: made.cycle and made.cycle.peak_force),
        Quantity("block_masses", "g", holds=[float]),
        Quantity("findings", holds=[FINDING]),
        Quantity("parts", holds=[PART], read=parts_of),
        Quantity("fasteners", holds=[FASTENER], read=lambda one: fastener_counts(one.layout)),
        Quantity("bands", holds=[BAND]),
        Quantity("sweep", holds=_SWEEP),
        Quantity("yield", read="yield_", holds=sampled, missing=True),
        Quantity("hopper", holds=_HOPPER, read="of_hopper", missing=True),
        *keys(notes=[str]),
    )


def _of_unit(name: str, unit: str) -> Quantity:
    """A number of a finding; null unless it has this unit."""
    si = base.UNITS[unit].si if unit in base.UNITS else unit or "1"

    def read(one: ExceededLimit) -> float | None:
        return getattr(one, name) if one.unit == si else None

    return Quantity(name, unit, read=read) if unit else Quantity(name, read=read, holds=float)


FINDING: Schema = (
    *keys(check=str, parts=[str]),
    *(_of_unit(name, unit) for unit in ("mm", "MPa", "N") for name in ("value", "allowed")),
    *(
        Quantity(f"{name}_ratio", read=_of_unit(name, "").read, holds=float)
        for name in ("value", "allowed")
    ),
    *keys(problem=str, advice=str),
)


def _size(part: Part, axis: int) -> float:
    bounds = part.outline.bounds
    return bounds[axis + 2] - bounds[axis]


PART: Schema = (
    Quantity("name", head="part", read="part.name"),
    Quantity("mark", head="mark", read="part.mark"),
    Quantity("layer", head="layer", read="part.layer", holds=int, left=False),
    Quantity("base", "mm", "z", "part.base"),
    Quantity("width", "mm", "along", lambda row: _size(row["part"], 0)),
    Quantity("height", "mm", "across", lambda row: _size(row["part"], 1)),
    Quantity("holes", head="holes", read=lambda row: len(row["part"].holes), holds=int, left=False),
    Quantity("mass", "g", "mass"),
)
FASTENER: Schema = (
    Quantity("use", head="use", read=itemgetter(0)),
    Quantity("size", head="size", read=itemgetter(1)),
    Quantity("count", head="count", read=itemgetter(2), holds=int, left=False),
)


def _end(name: str, number: int) -> Callable[[BandUse], float]:
    return lambda one: getattr(one, name)[number]


_LOAD: Schema = (
    Quantity("name", head="impact"),
    Quantity("energy", "mJ", "energy", form=3),
    Quantity("force", "N", "force over 1 mm", form=3),
    Quantity("lever_force", "N", "lever", form=3),
    Quantity("bearing", "MPa", "holes", form=3),
    Quantity("web", "MPa", "webs", form=3),
    Quantity("pin", "MPa", "pins", form=3),
    Quantity("face", "MPa", "faces", form=3),
    Quantity("give", "mm", "least give of the pad", form=3),
)
_HOPPER: Schema = (
    *keys(copies=int, body_mass="g", foot_mass="g"),
    *keys(assumed_body_mass="g", assumed_foot_mass="g"),
    Quantity("impacts", holds=[_LOAD]),
)
BAND: Schema = (
    Quantity("cell", head="cell", read=lambda one: one.cell + 1, holds=int, left=False),
    Quantity("band", head="band", read=lambda one: one.number + 1, holds=int, left=False),
    Quantity("holes", head="holes", form=" ".join, holds=[str]),
    Quantity("rest_length", "mm", "free length"),
    Quantity("length_0", "mm", "length 0", _end("lengths", 0)),
    Quantity("length_1", "mm", "length 1", _end("lengths", 1)),
    *keys(shortest="mm", longest="mm"),
    Quantity("tension_0", "N", "tension 0", _end("tensions", 0), form=3),
    Quantity("tension_1", "N", "tension 1", _end("tensions", 1), form=3),
    Quantity("scale_0", "g", "scale 0", lambda one: one.tensions[0] / base.GRAVITY, form=3),
    Quantity("scale_1", "g", "scale 1", lambda one: one.tensions[1] / base.GRAVITY, form=3),
    Quantity("stretch", head="stretch", form=3, holds=float, left=False),
    Quantity("shift", "mm", holds=[float]),
    Quantity("fits", "mm", holds=[float]),
)
CLEARANCE: Schema = (
    Quantity("parts", head="parts", holds=[str]),
    Quantity("distance", "mm", "least distance", form=lambda mm: _distance_words(mm)),
)
_COLLISION: Schema = (
    *keys(parts=[str], cells=([int], lambda one: [cell + 1 for cell in one.cells])),
    Quantity("travels", "mm", holds=[[float]]),
    Quantity("stroke", "mm", holds=[float]),
    *keys(states=[str], overlap="mm"),
)
_SWEEP: Schema = (
    *keys(free=bool, pairs=int),
    Quantity("collisions", holds=[_COLLISION]),
    Quantity("undecided", holds=[[str]]),
    Quantity("clearances", holds=[CLEARANCE]),
)


def _distance_words(millimetres: float) -> str:
    return "they touch at the stops" if millimetres <= 0.01 else number(millimetres, 2)


def parts_of(made: Build | RobotBuild) -> list[dict[str, Any]]:
    """Each cut part with its mass [kg]."""
    density = made.build_file.sheet.density
    return [{"part": part, "mass": part.mass(density)} for part in made.parts]


def fastener_counts(layout: Layout | RobotLayout) -> list[tuple[str, str, int]]:
    """Use, size and count of the fasteners; heads belong to screws."""
    counts = Counter((one.use, one.size) for one in layout.fasteners if one.size)
    return [(use, size, count) for (use, size), count in sorted(counts.items())]


def build_account(made: Build, about: About) -> Account:
    """What is reported of a build."""
    sheet, chain = made.build_file.sheet, made.chain
    # Stops touch, and pins run in slots with their fit.
    fit = made.build_file.pin.lever_fit / 2.0 + 1e-6
    closest: list[Clearance] = [one for one in made.sweep.clearances if one.distance > fit]
    of_sheet = f"{counted(len(made.parts), 'part')} of {amount(sheet.thickness, 'm')} "
    of_sheet += sheet.material
    clear = "which clear" if made.of_hopper is None else "of which those of the chain clear"
    verdict = (
        f"It can be built: {of_sheet}, {amount(made.mass, 'kg', 3)}, {clear} each other at all "
        "angles"
        if made.can_be_built
        else f"It cannot be built as it is: {counted(len(made.findings), 'finding')}"
    )
    sampled = made.yield_
    facts = (
        Fact("Build file", made.build_file.title),
        Fact("Sweep", sweep_words(made.sweep, "any angles, which is proved")),
        Fact("Least clearance", closest_words(closest)),
        Fact("Yield", "" if sampled is None else _yield_words(made)),
        Fact("Errors of a build", "" if sampled is None else yields.sample_words(sampled)),
        Fact("Mass", _mass_words(made)),
        Fact("Actuator", _actuator_words(made)),
        Fact("Hopper", _hopper_words(made)),
    )
    parts = RecordTable(PART, recorded(PART, parts_of(made)), more="parts", level=FULL)
    scales = [one for one in BAND if one.name.startswith("scale")]
    bands = RecordTable(
        [one for one in BAND if one not in scales],
        recorded(BAND, made.bands),
        "Holes of the hooks on the inner and the outer block; 0 and 1 are the states of the cell, "
        "and the scale is a kitchen scale that the band pulls.",
        scales,
        more="bands",
        level=CARD,
    )
    fasteners = RecordTable(FASTENER, recorded(FASTENER, fastener_counts(made.layout)), level=FULL)
    close = RecordTable(
        CLEARANCE,
        recorded(CLEARANCE, made.sweep.clearances),
        "Pairs that come closer than 1.5 mm; least distances exact to 0.1 mm. Pins in slots have "
        "the fit of the build file.",
        more="pairs",
        level=FULL,
    )
    sections = {
        "Findings": Notes([str(one) for one in made.findings], CARD, first_of(made)),
        "Notes": Notes(made.notes),
        "Bands": bands,
        "Parts": (parts, Picture("layers", "The parts in their layers, all cells at 0")),
        "Fasteners": fasteners,
        "Clearances": close,
        **_impacts(made),
        **assumed(chain, *_ASSUMED),
    }
    title, origin = chain.title or "A build", f"{cells_of(chain)}."
    seed = None if sampled is None else sampled.seed
    return Account(made, title, "build/1", verdict, facts, sections, (), origin, seed=seed)


def _impacts(made: Build) -> Sections:
    """What the impacts of a hopper ask of its parts."""
    if made.of_hopper is None:
        return {}
    sheet, pin = made.build_file.sheet.strength, made.build_file.pin.strength
    about = (
        "Of one chain, from the bound without losses. The force is the mean of an impact over "
        "1 mm, as of a pad; its levers share it equally and carry no bending. Allowed are "
        f"{amount(sheet, 'Pa', 3)} in holes, webs and faces of the sheet and "
        f"{amount(pin, 'Pa', 3)} in pins. The pad has to give way by the last column."
    )
    return {"Impacts": RecordTable(_LOAD, recorded(_LOAD, made.of_hopper.impacts), about)}


def _hopper_words(made: Build) -> str:
    if made.of_hopper is None:
        return ""
    hopper = made.of_hopper
    body, foot = (amount(one, "kg", 3) for one in (hopper.body_mass, hopper.foot_mass))
    least = max((one.give for one in hopper.impacts), default=0.0)
    return (
        f"{hopper.copies} such chains with frame, foot bar and sole: body {body} without actuator "
        f"and springs, foot {foot}; pads that give way by {amount(least, 'm', 2)} or more"
    )


def first_of(made: Build | RobotBuild) -> list[str]:
    """The first finding and the number of the others, for a screen; empty without others."""
    first, *others = map(str, made.findings or [""])
    more = counted(len(others), "more finding")
    return [first, f"{more}: --full lists all of them."] if others else []


# Of every build; the numbers are those of the build file.
_ASSUMED = (
    "The sweep is of nominal sizes: errors and sag use up clearances.",
    "Bands are straight between their hooks, also slack ones.",
    "Loads are static: levers and pins carry bands and actuator along the full cycle.",
    "Errors of stops count as errors of anchors with the same change of the critical forces.",
)


def sweep_words(swept: MotionSweep, where: str) -> str:
    """Whether the parts are free; `where` has the poses of the sweep."""
    pairs = counted(swept.pairs, "pair")
    if swept.free:
        return f"no overlap of {pairs} of bodies at {where}"
    if swept.collisions:
        overlaps = counted(len(swept.collisions), "overlap")
        return f"{overlaps} of parts, the deepest {amount(swept.collisions[0].overlap, 'm', 3)}"
    return f"undecided for {counted(len(swept.undecided), 'pair')} of bodies"


def closest_words(closest: list[Clearance]) -> str:
    """The least clearance of all."""
    if not closest:
        return ""
    first = closest[0]
    return f"{amount(first.distance, 'm', 2)} between {' and '.join(first.parts)}"


def _yield_words(made: Build) -> str:
    sampled = made.yield_
    assert sampled is not None
    of_100 = f"{100.0 * sampled.fraction:.3g} of 100 builds reproduce {sampled.target}"
    low, high = map(base.percent, sampled.interval)
    return f"{of_100}, with 95 % confidence {low} to {high}"


def _mass_words(made: Build) -> str:
    blocks = ", ".join(number(base.to_unit(one, "g"), 3) for one in made.block_masses)
    return (
        f"{amount(made.mass, 'kg', 3)} of sheet, {amount(made.fastener_mass, 'kg', 2)} of "
        f"fasteners; blocks {blocks} g"
    )


def _actuator_words(made: Build) -> str:
    stroke = amount(made.chain.full_stroke, "m")
    if made.cycle is None:
        return f"{stroke} of travel"
    return f"{stroke} of travel, {amount(abs(made.cycle.peak_force), 'N', 3)} at most"
