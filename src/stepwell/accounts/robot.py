"""A robot, the gait that statics predicts for it, and the arena that it walks in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from stepwell import base, files
from stepwell.accounts import parts
from stepwell.accounts.head import About
from stepwell.base import Quantity, Schema
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
PARAMETERS = Quantity("parameters", holds=[PARAMETER], read=files.provenance)
_ROBOT: Schema = (*base.quantities(title=str, mass="g", weight="N", u_max="mm"), PARAMETERS)
_NEEDS: Schema = base.quantities(push="N", pull="N", stiffness="N_per_m")
_PUSH: Schema = (
    Quantity("direction", head="while", read=lambda p: "loading" if p.loading else "unloading"),
    *base.quantities(step="mm", gain="mm", load="N"),
    Quantity("drag", "N", "drag", form=3),
    Quantity("largest_drag", "N", "largest drag", form=3, none="any"),
    Quantity("limit", head="then", read="limit.value"),
)
_FLIP: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("displacement", "mm", "anchor moved", form=3),
    *base.quantities(earliest="mm", latest="mm"),
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
    *base.quantities(alternatives=[str], near_boundary=bool, pushes=[_PUSH], flips=[_FLIP]),
)
# The depths at which a leg keeps its gait, in results of statics and of simulation.
FEET = Quantity("feet", "mm", holds=[float], missing=True)
_PREDICTION: Schema = (
    *base.quantities(
        motion=Motion,
        advance="over_u_max",
        sideways="over_u_max",
        turn="deg",
        first_advance="over_u_max",
        too_soft=str,
        near_boundary=bool,
        drive_needs=_NEEDS,
    ),
    Quantity("legs", holds=[(*base.read_off(_LEG, "leg"), FEET)], read=lambda found: _legs(found)),
    Quantity("assumptions", holds=[str]),
)


def _legs(found: Prediction) -> Sequence[parts.Row]:
    return base.rows_of({"leg": found.legs, "feet": found.known_depths})


def arena_account(arena: Arena, about: About) -> parts.Account:
    """What a notebook shows of an arena."""
    answer = (
        f"{base.counted(len(arena.walls), 'wall')} and "
        f"{base.counted(len(arena.cylinders), 'cylinder')}"
        f"{', and a goal' * (arena.goal is not None)}."
    )
    return parts.Account(arena, arena.title or "Arena", answer=answer)


def robot_account(robot: Robot, about: About) -> parts.Account:
    """What a notebook shows of a robot."""
    drive = robot.drive
    return parts.Account(
        robot,
        robot.title or "Robot",
        answer="One actuator drives every leg; what it does follows from its springs.",
        facts=[
            *_robot_facts(robot),
            parts.Fact("Legs", ", ".join(leg.name for leg in robot.legs)),
            parts.Fact(
                "Drive", f"{base.amount(drive.amplitude, 'm')} in {base.amount(drive.period, 's')}"
            ),
            parts.Fact("Antennas", ", ".join(one.name for one in robot.antennas)),
        ],
    )


def _robot_facts(robot: Robot, level: parts.Level = parts.Level.CARD) -> list[parts.Fact]:
    return [
        parts.Fact("Mass", base.amount(robot.mass, "kg"), level),
        parts.Fact("Weight", base.amount(robot.weight, "N"), level),
        parts.Fact("u_max", base.amount(robot.u_max, "m"), level),
    ]


# What is reported of a robot and its prediction.
ROBOT: Schema = (
    *base.read_off(_ROBOT, "robot"),
    Quantity("prediction", holds=_PREDICTION, read=lambda found: found),
)


def prediction_account(found: Prediction, about: About) -> parts.Account:
    """What is reported of a prediction."""
    robot = found.robot
    doubts = [
        f"{leg.name} may go {' or '.join(leg.alternatives or [leg.nearest])} as well."
        for leg in found.legs
        if leg.near_boundary
    ]

    return parts.Account(
        found,
        kind="robot/1",
        schema=ROBOT,
        title=robot.title or "A robot",
        origin="Predicted by statics, without simulation.",
        answer=f"{found.motion.value}: d/u_max {found.advance:z.2f} and "
        f"{turn_words(found.turn)} per cycle",
        facts=(
            *_robot_facts(robot, parts.Level.TERMINAL),
            parts.Fact(
                "Drive requirements", lambda: _needs(found.drive_needs), parts.Level.TERMINAL
            ),
            parts.Fact(
                "Foot depth", lambda: depth_words(robot, found.known_depths), parts.Level.TERMINAL
            ),
            assumed(robot),
        ),
        warnings=(
            parts.Warned(
                "Too close to call", "Statics cannot determine which gait these legs have.", doubts
            ),
            parts.Warned(
                "Soft drive",
                "The stiffness of the drive changes the gait.",
                [f"{found.too_soft}."] if found.too_soft else [],
            ),
        ),
        sections=(
            parts.Section(
                "The robot",
                parts.Picture("robot", "The robot from the side and from above"),
                parts.Picture("prediction", "The gait that statics predicts"),
            ),
            parts.Section(
                "Predicted gaits",
                parts.RecordTable(
                    _LEG,
                    lambda: [base.record(_LEG, leg) for leg in found.legs],
                    "Margin: the smallest force on one cell that changes the gait. "
                    "Uncertainty: the force that the prediction does not know.",
                    most=None,
                    more="legs",
                    level=parts.Level.CARD,
                ),
            ),
            parts.Section(
                "Pushes",
                parts.RecordTable(
                    (_LEG_NAME, _PUSH[0], _GAIN, *_PUSH[4:]),
                    "prediction",
                    "How far the body goes of each step, and up to which drag of the floor.",
                    most=None,
                    more="pushes",
                    pick=partial(_of_legs, "pushes"),
                ),
            ),
            parts.Section(
                "Gait changes by antennas",
                parts.RecordTable(
                    (_FLIP[0], _LEG_NAME, _FLIP[1], _INTERVAL, *_FLIP[4:]),
                    "prediction",
                    "How far an antenna moves the anchor before the gait of its leg changes.",
                    most=None,
                    more="changes",
                    pick=partial(_of_legs, "flips"),
                ),
            ),
            parameter_section(robot, parts.Level.TERMINAL),
            parts.Section("Assumptions", parts.Notes(found.assumptions, parts.Level.PAGE)),
        ),
    )


def _of_legs(key: str, prediction: parts.Row) -> list[parts.Row]:
    return [{"leg": leg["name"], **one} for leg in prediction["legs"] for one in leg[key]]


def _needs(needs: DriveNeeds) -> str:
    """What a motor must have for the gait."""
    stiffness = needs.stiffness
    enough = f"{base.number(stiffness, 3)} N/m or more" if stiffness else "any stiffness"
    push, pull = base.number(needs.push, 3), base.number(needs.pull, 3)
    return f"{push} N loading, {pull} N unloading, {enough}"


def _interval(flip: parts.Row) -> str:
    earliest = base.number(flip["earliest_mm"], 3)
    if flip["latest_mm"] is None:
        return f"from {earliest}, or never"
    return f"{earliest} to {base.number(flip['latest_mm'], 3)}"


_LEG_NAME = base.Column("leg", lambda row: row["leg"])
_GAIN = base.Column(
    "gains [mm]", lambda push: f"{push['gain_mm']:.1f} of {push['step_mm']:.1f}", True
)
_INTERVAL = base.Column("interval [mm]", _interval, True)
# The unit of the values is in the key.
_VALUES = base.Column("value", lambda row: ", ".join(f"{one:.6g}" for one in row["values"]), True)


def turn_words(turn: float) -> str:
    """A rotation [rad]."""
    return f"{math.degrees(turn):z.1f}° to the left"


def depth_words(robot: Robot, depths: Sequence[tuple[float, float] | None]) -> str:
    """How deep the feet stand, and the depths [m] between which each leg keeps its gait."""
    each = [
        f"{leg.name} {base.to_unit(one[0], 'mm'):.2f} to {base.to_unit(one[1], 'mm'):.2f} mm"
        for leg, one in zip(robot.legs, depths, strict=True)
        if one is not None
    ]
    found = f"{base.amount(robot.foot.below, 'm')} below the supports"
    return found + (f"; the predicted gait stays: {', '.join(each)}" if each else "")


def assumed(robot: Robot) -> parts.Fact:
    """How many numbers of a robot are assumed."""
    sources = [one.source for one in files.provenance(robot)]
    text = f"{sources.count('assumed')} of {len(sources)}"
    return parts.Fact("Assumed numbers", text, parts.Level.TERMINAL)


def parameter_section(robot: Robot, level: parts.Level = parts.Level.PAGE) -> parts.Section:
    """Every number of a robot with its source."""
    columns = (PARAMETER[0], _VALUES, *PARAMETER[2:])
    about = "Every number with its source; its key is that of the design file."
    rows = partial(_parameter_rows, robot)
    return parts.Section(
        "Parameters",
        parts.RecordTable(columns, rows, about, most=None, more="numbers", level=level),
    )


def _parameter_rows(robot: Robot) -> list[parts.Row]:
    return [base.record(PARAMETER, one) for one in files.provenance(robot)]
