"""A robot, the gait that statics predicts for it, and the arena that it walks in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from stepwell.accounts.head import About
from stepwell.accounts.parts import (
    Account,
    Fact,
    Level,
    Notes,
    Picture,
    RecordTable,
    Row,
    Section,
    Warned,
)
from stepwell.base import (
    Column,
    Quantity,
    Schema,
    amount,
    counted,
    number,
    quantities,
    read_off,
    record,
    rows_of,
    to_unit,
)
from stepwell.files import provenance
from stepwell.robot import Motion

if TYPE_CHECKING:
    from stepwell.robot import Arena, DriveNeeds, Prediction, Robot

# Where the sources of a robot's numbers are, for results of its simulation.
SOURCES = "`stepwell robot show` lists every number of a robot with its source."

PARAMETER: Schema = (
    Quantity("key", read="path", head="key"),
    Quantity("values", holds=[float]),
    Quantity("unit", head="unit"),
    Quantity("source", head="source"),
)
PARAMETERS = Quantity("parameters", holds=[PARAMETER], read=provenance)
_ROBOT: Schema = (*quantities(title=str, mass="g", weight="N", u_max="mm"), PARAMETERS)
_NEEDS: Schema = quantities(push="N", pull="N", stiffness="N_per_m")
_PUSH: Schema = (
    Quantity("direction", head="while", read=lambda p: "loading" if p.loading else "unloading"),
    *quantities(step="mm", gain="mm", load="N"),
    Quantity("drag", "N", "drag", form=3),
    Quantity("largest_drag", "N", "largest drag", form=3, none="any"),
    Quantity("limit", head="then", read="limit.value"),
)
_FLIP: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("displacement", "mm", "anchor moved", form=3),
    *quantities(earliest="mm", latest="mm"),
    Quantity("swing", "deg", "swing", form=3),
    Quantity("gait", head="then"),
)
_LEG: Schema = (
    Quantity("name", head="leg"),
    Quantity("gait", head="states"),
    Quantity("first_gait"),
    Quantity("advance", "over_u_max", "d/u_max", form=".2f"),
    Quantity("slip", "mm"),
    Quantity("margin", "mN", "margin", form=3, none="over 2000"),
    Quantity("uncertainty", "mN", "uncertainty", form=3),
    Quantity("nearest", head="past the margin"),
    *quantities(alternatives=[str], near_boundary=bool, pushes=[_PUSH], flips=[_FLIP]),
)
# The depths at which a leg keeps its gait, in results of statics and of simulation.
FEET = Quantity("feet", "mm", holds=[float], missing=True)
_PREDICTION: Schema = (
    *quantities(
        motion=Motion,
        advance="over_u_max",
        sideways="over_u_max",
        turn="deg",
        first_advance="over_u_max",
        too_soft=str,
        near_boundary=bool,
        drive_needs=_NEEDS,
    ),
    Quantity("legs", holds=[(*read_off(_LEG, "leg"), FEET)], read=lambda found: _legs(found)),
    Quantity("assumptions", holds=[str]),
)


def _legs(found: Prediction) -> Sequence[Row]:
    return rows_of({"leg": found.legs, "feet": found.known_depths})


def arena_account(arena: Arena, about: About) -> Account:
    """What a notebook shows of an arena."""
    answer = (
        f"{counted(len(arena.walls), 'wall')} and {counted(len(arena.cylinders), 'cylinder')}"
        f"{', and a goal' * (arena.goal is not None)}."
    )
    return Account(arena, arena.title or "Arena", answer=answer)


def robot_account(robot: Robot, about: About) -> Account:
    """What a notebook shows of a robot."""
    drive = robot.drive
    return Account(
        robot,
        robot.title or "Robot",
        answer="One actuator drives every leg; what it does follows from its springs.",
        facts=[
            *_robot_facts(robot),
            Fact("Legs", ", ".join(leg.name for leg in robot.legs)),
            Fact("Drive", f"{amount(drive.amplitude, 'm')} in {amount(drive.period, 's')}"),
            Fact("Antennas", ", ".join(one.name for one in robot.antennas)),
        ],
    )


def _robot_facts(robot: Robot, level: Level = Level.CARD) -> list[Fact]:
    return [
        Fact("Mass", amount(robot.mass, "kg"), level),
        Fact("Weight", amount(robot.weight, "N"), level),
        Fact("u_max", amount(robot.u_max, "m"), level),
    ]


# What is reported of a robot and its prediction.
ROBOT: Schema = (
    *read_off(_ROBOT, "robot"),
    Quantity("prediction", holds=_PREDICTION, read=lambda found: found),
)


def prediction_account(found: Prediction, about: About) -> Account:
    """What is reported of a prediction."""
    robot = found.robot
    doubts = [
        f"{leg.name} may go {' or '.join(leg.alternatives or [leg.nearest])} as well."
        for leg in found.legs
        if leg.near_boundary
    ]

    return Account(
        found,
        kind="robot/1",
        schema=ROBOT,
        title=robot.title or "A robot",
        origin="Predicted by statics, without simulation.",
        answer=f"{found.motion.value}: d/u_max {found.advance:z.2f} and "
        f"{turn_words(found.turn)} per cycle",
        facts=(
            *_robot_facts(robot, Level.TERMINAL),
            Fact("Drive requirements", lambda: _needs(found.drive_needs), Level.TERMINAL),
            Fact("Foot depth", lambda: depth_words(robot, found.known_depths), Level.TERMINAL),
            assumed(robot),
        ),
        warnings=(
            Warned(
                "Too close to call", "Statics cannot determine which gait these legs have.", doubts
            ),
            Warned(
                "Soft drive",
                "The stiffness of the drive changes the gait.",
                [f"{found.too_soft}."] if found.too_soft else [],
            ),
        ),
        sections=(
            Section(
                "The robot",
                Picture("robot", "The robot from the side and from above"),
                Picture("prediction", "The gait that statics predicts"),
            ),
            Section(
                "Predicted gaits",
                RecordTable(
                    _LEG,
                    lambda: [record(_LEG, leg) for leg in found.legs],
                    "Margin: the smallest force on one cell that changes the gait. "
                    "Uncertainty: the force that the prediction does not know.",
                    most=None,
                    more="legs",
                    level=Level.CARD,
                ),
            ),
            Section(
                "Pushes",
                RecordTable(
                    (_LEG_NAME, _PUSH[0], _GAIN, *_PUSH[4:]),
                    "prediction",
                    "How far the body goes of each step, and up to which drag of the floor.",
                    most=None,
                    more="pushes",
                    pick=partial(_of_legs, "pushes"),
                ),
            ),
            Section(
                "Gait changes by antennas",
                RecordTable(
                    (_FLIP[0], _LEG_NAME, _FLIP[1], _INTERVAL, *_FLIP[4:]),
                    "prediction",
                    "How far an antenna moves the anchor before the gait of its leg changes.",
                    most=None,
                    more="changes",
                    pick=partial(_of_legs, "flips"),
                ),
            ),
            parameter_section(robot, Level.TERMINAL),
            Section("Assumptions", Notes(found.assumptions, Level.PAGE)),
        ),
    )


def _of_legs(key: str, prediction: Row) -> list[Row]:
    return [{"leg": leg["name"], **one} for leg in prediction["legs"] for one in leg[key]]


def _needs(needs: DriveNeeds) -> str:
    """What a motor must have for the gait."""
    stiffness = needs.stiffness
    enough = f"{number(stiffness, 3)} N/m or more" if stiffness else "any stiffness"
    return f"{number(needs.push, 3)} N loading, {number(needs.pull, 3)} N unloading, {enough}"


def _interval(flip: Row) -> str:
    earliest = number(flip["earliest_mm"], 3)
    if flip["latest_mm"] is None:
        return f"from {earliest}, or never"
    return f"{earliest} to {number(flip['latest_mm'], 3)}"


_LEG_NAME = Column("leg", lambda row: row["leg"])
_GAIN = Column("gains [mm]", lambda push: f"{push['gain_mm']:.1f} of {push['step_mm']:.1f}", True)
_INTERVAL = Column("interval [mm]", _interval, True)
# The unit of the values is in the key.
_VALUES = Column("value", lambda row: ", ".join(f"{one:.6g}" for one in row["values"]), True)


def turn_words(turn: float) -> str:
    """A rotation [rad]."""
    return f"{math.degrees(turn):z.1f}° to the left"


def depth_words(robot: Robot, depths: Sequence[tuple[float, float] | None]) -> str:
    """How deep the feet stand, and the depths [m] between which each leg keeps its gait."""
    each = [
        f"{leg.name} {to_unit(one[0], 'mm'):.2f} to {to_unit(one[1], 'mm'):.2f} mm"
        for leg, one in zip(robot.legs, depths, strict=True)
        if one is not None
    ]
    found = f"{amount(robot.foot.below, 'm')} below the supports"
    return found + (f"; the predicted gait stays: {', '.join(each)}" if each else "")


def assumed(robot: Robot) -> Fact:
    """How many numbers of a robot are assumed."""
    sources = [one.source for one in provenance(robot)]
    text = f"{sources.count('assumed')} of {len(sources)}"
    return Fact("Assumed numbers", text, Level.TERMINAL)


def parameter_section(robot: Robot, level: Level = Level.PAGE) -> Section:
    """Every number of a robot with its source."""
    columns = (PARAMETER[0], _VALUES, *PARAMETER[2:])
    about = "Every number with its source; its key is that of the design file."
    rows = partial(_parameter_rows, robot)
    return Section(
        "Parameters", RecordTable(columns, rows, about, most=None, more="numbers", level=level)
    )


def _parameter_rows(robot: Robot) -> list[Row]:
    return [record(PARAMETER, one) for one in provenance(robot)]
