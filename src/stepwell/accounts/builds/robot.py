"""A build of a robot: whether its parts can be made, what they weigh, what to buy, its period."""

import math
from collections.abc import Iterable, Iterator
from operator import itemgetter

from stepwell import base
from stepwell.accounts.builds import chain as chains
from stepwell.accounts.head import About, keys, recorded
from stepwell.accounts.parts import CARD, FULL, Account, Fact, Notes, Picture, RecordTable
from stepwell.base import Quantity, Schema, amount, counted, number
from stepwell.build import RobotBuild


def nanometres(values: Iterable[float]) -> Iterator[float]:
    """Lengths [m] without what rounding adds to them."""
    return (round(float(one), 9) + 0.0 for one in values)


_MASS: Schema = (
    Quantity("body", head="body"),
    Quantity("mass", "g", "mass", form=4),
    Quantity("centre", "mm", read=lambda one: [*nanometres(one.centre)], holds=[float]),
)
_GROUP: Schema = (Quantity("group", read=itemgetter(0)), Quantity("mass", "g", read=itemgetter(1)))
_BAND: Schema = (
    Quantity("leg", head="leg", read=lambda row: row["words"][0]),
    *base.read_off(chains.BAND[1:], "use"),
)
_RANGE: Schema = (
    Quantity("parameter", read=lambda one: " ".join(map(str, one[0])).strip()),
    # Angles, but of the carriage its stroke.
    Quantity("deg", read=lambda one: None if _sliding(one) else _degrees(one), holds=[float]),
    Quantity("mm", read=lambda one: _millimetres(one) if _sliding(one) else None, holds=[float]),
)
_OVERLAP: Schema = (
    *keys(parts=[str]),
    Quantity("ranges", holds=[_RANGE]),
    *keys(states=[str], overlap="mm"),
)
_SWEEP: Schema = (
    *keys(free=bool, pairs=int),
    Quantity("collisions", holds=[_OVERLAP]),
    Quantity("undecided", holds=[[str]]),
    Quantity("clearances", holds=[chains.CLEARANCE]),
)


def _sliding(one: tuple[tuple[str, object], float, float]) -> bool:
    return one[0][0] in ("stroke", "across")


def _degrees(one: tuple[object, float, float]) -> list[float]:
    return [math.degrees(value) for value in one[1:]]


def _millimetres(one: tuple[object, float, float]) -> list[float]:
    return [base.to_unit(value, "mm") for value in one[1:]]


def _bands(made: RobotBuild) -> list[dict[str, object]]:
    return [{"use": one, "words": made.band_words(one)} for one in made.bands]


ROBOT_BUILD: Schema = (
    *keys(title=str, can_be_built=bool, build_file=(str, "build_file.title")),
    *base.read_off(keys(material=str, thickness="mm"), "build_file.sheet"),
    *keys(mass="g", sheet_mass="g"),
    Quantity("centre", "mm", read=lambda made: [*nanometres(made.centre)], holds=[float]),
    Quantity("group_masses", holds=[_GROUP], read=lambda made: [*made.group_masses.items()]),
    Quantity("masses", holds=[_MASS]),
    *keys(stroke=("mm", "layout.plan.stroke"), peak_force="N", least_period="s"),
    *base.read_off(
        keys(
            actuator=(str, "name"), actuator_travel=("mm", "travel"), actuator_force=("N", "force")
        ),
        "build_file.linear_actuator",
    ),
    Quantity("findings", holds=[chains.FINDING]),
    Quantity("parts", holds=[chains.PART], read=chains.parts_of),
    Quantity("fasteners", holds=[chains.FASTENER], read=lambda m: chains.fastener_counts(m.layout)),
    Quantity("bands", holds=[_BAND], read=_bands),
    Quantity("sweep", holds=_SWEEP),
    *keys(notes=[str]),
)


def robot_build_account(made: RobotBuild, about: About) -> Account:
    """What is reported of a build of a robot."""
    sheet = made.build_file.sheet
    of_sheet = f"{counted(len(made.layout.parts), 'part')} of {amount(sheet.thickness, 'm')} "
    of_sheet += sheet.material
    verdict = (
        f"It can be built: {of_sheet}, {amount(made.mass, 'kg', 3)} with actuator and battery, "
        "which clear each other at all states and antenna positions"
        if made.can_be_built
        else f"It cannot be built as it is: {counted(len(made.findings), 'finding')}"
    )
    # Stops touch, and sliders run in rails with their fit.
    fit = made.build_file.robot.rail_fit + 1e-6
    closest = [one for one in made.sweep.clearances if one.distance > fit]
    facts = (
        Fact("Build file", made.build_file.title),
        Fact("Sweep", chains.sweep_words(made.sweep, "any state and antenna position, proved")),
        Fact("Least clearance", chains.closest_words(closest)),
        Fact("Mass", _mass_words(made)),
        Fact("Centre of mass", f"({_millimetre_words(made.centre)}) mm, at rest"),
        Fact("Actuator", _actuator_words(made)),
        Fact("Shortest period", _period_words(made)),
    )
    masses = RecordTable(
        _MASS[:2], recorded(_MASS, made.masses), "Rigid bodies, with pins and screws.", level=FULL
    )
    parts = RecordTable(
        chains.PART, recorded(chains.PART, chains.parts_of(made)), more="parts", level=FULL
    )
    bands = RecordTable(
        _BAND,
        recorded(_BAND, _bands(made)),
        "Holes of the hooks on the inner and the outer block; 0 and 1 are the states of the cell, "
        "and the scale is a kitchen scale that the band pulls.",
        [one for one in _BAND if one.name.startswith("scale")],
        more="bands",
        level=CARD,
    )
    fasteners = RecordTable(
        chains.FASTENER, recorded(chains.FASTENER, chains.fastener_counts(made.layout)), level=FULL
    )
    close = RecordTable(
        chains.CLEARANCE,
        recorded(chains.CLEARANCE, made.sweep.clearances),
        "Pairs that come closer than 1.5 mm; least distances exact to 0.1 mm. Sliders and pins in "
        "slots have the fits of the build file.",
        more="pairs",
        level=FULL,
    )
    sections = {
        "Findings": Notes([str(one) for one in made.findings], CARD, chains.first_of(made)),
        "Notes": Notes(made.notes),
        "Bands": bands,
        "Masses": masses,
        "Parts": (parts, Picture("parts", "The robot in its parts, from above and from the side")),
        "Fasteners": fasteners,
        "Clearances": close,
        "Assumptions": Notes(_ASSUMED, FULL),
    }
    title, origin = made.title, f"{counted(len(made.drawing.legs), 'leg')} on one actuator."
    return Account(made, title, "robot_build/1", verdict, facts, sections, (), origin)


_ASSUMED = (
    "The sweep is of nominal sizes: errors and sag use up clearances.",
    "Both legs take any states, and antennas any positions, independently of each other.",
    "Bands and cords are straight; a cord is in tension at all swings.",
    "Pins and screws are steel cylinders, posts are of nylon; cords and bands weigh nothing.",
    "The force of the actuator is that of the cells without friction, and the drag of the floor.",
    "The friction of the rails is not computed: it depends on material and lubrication.",
)


def _mass_words(made: RobotBuild) -> str:
    grams = [
        f"{name} {number(base.to_unit(mass, 'g'), 3)}" for name, mass in made.group_masses.items()
    ]
    return f"{amount(made.sheet_mass, 'kg', 3)} of sheet; {', '.join(grams)} g"


def _millimetre_words(values: tuple[float, ...]) -> str:
    rounded = [round(base.to_unit(one, "mm"), 1) + 0.0 for one in values]
    return ", ".join(f"{one:g}" for one in rounded)


def _actuator_words(made: RobotBuild) -> str:
    own, stroke = made.build_file.linear_actuator, made.layout.plan.stroke
    return (
        f"{own.name}: {amount(stroke, 'm')} of {amount(own.travel, 'm')} of travel, "
        f"{amount(made.peak_force, 'N', 3)} of {amount(own.force, 'N', 3)}"
    )


def _period_words(made: RobotBuild) -> str:
    speed, twice = made.build_file.linear_actuator.speed, 2.0 * made.layout.plan.stroke
    return (
        f"{amount(made.least_period, 's', 3)} a cycle: {amount(twice, 'm')} of travel at "
        f"{number(base.to_unit(speed, 'mm/s'), 3)} mm/s"
    )
