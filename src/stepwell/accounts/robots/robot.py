"""Robots, their gaits as predicted by statics, and arenas."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from stepwell import base, files
from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, keys, recorded
from stepwell.accounts.parts import CARD, FULL, TERMINAL, Account, Fact, Picture, RecordTable
from stepwell.base import Quantity, Schema, amount, counted, number
from stepwell.robot import Arena, DriveNeeds, Motion, Prediction, Robot

if TYPE_CHECKING:
    from stepwell.paper import AssumedRanges

PARAMETER: Schema = (
    Quantity("key", read="path", head="key"),
    # The unit of the values is in the key.
    Quantity("values", head="value", form=6, left=False, holds=[float]),
    Quantity("unit", head="unit"),
    Quantity("source", head="source"),
)
PARAMETERS = Quantity("parameters", holds=[PARAMETER], read=files.provenance)
_PUSH: Schema = (
    Quantity("direction", head="while", read=lambda p: "loading" if p.loading else "unloading"),
    Quantity("step", "mm", "step", form=".1f"),
    Quantity("gain", "mm", "gain", form=".1f"),
    *keys(load="N"),
    Quantity("drag", "N", "drag", form=3),
    Quantity("largest_drag", "N", "largest drag", form=3, none="any"),
    Quantity("limit", head="then", read="limit.value"),
)
_FLIP: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("displacement", "mm", "anchor moved", form=3),
    Quantity("earliest", "mm", "earliest", form=3),
    Quantity("latest", "mm", "latest", form=3, none="never"),
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
    *keys(alternatives=[str], near_boundary=bool, pushes=[_PUSH], flips=[_FLIP]),
)
# The depths at which a leg keeps its gait, in results of statics and of simulation.
FEET = Quantity("feet", "mm", holds=[float], missing=True)
_PREDICTION: Schema = (
    *keys(motion=Motion, advance="over_u_max", sideways="over_u_max", turn="deg"),
    *keys(first_advance="over_u_max", too_soft=str, near_boundary=bool),
    *keys(drive_needs=keys(push="N", pull="N", stiffness="N_per_m")),
    Quantity(
        "legs",
        holds=[(*base.read_off(_LEG, "leg"), FEET)],
        read=lambda one: base.rows_of({"leg": one.legs, "feet": one.known_depths}),
    ),
    *keys(assumptions=[str]),
)


_RANGE: Schema = (
    Quantity("label", head="number"),
    Quantity("value", head="value", form=4, holds=float),
    Quantity("low", head="from", form=3, holds=float),
    Quantity("high", head="to", form=3, holds=float),
    Quantity("below", head="below"),
    Quantity("above", head="above"),
    *keys(keys=[str]),
)
RANGES = keys(title=(str, "robot.title"), gaits=[str], ranges=[_RANGE])


def arena_account(arena: Arena, about: About) -> Account:
    """Card of an arena in a notebook."""
    walls, cylinders = len(arena.walls), len(arena.cylinders)
    answer = f"{counted(walls, 'wall')} and {counted(cylinders, 'cylinder')}"
    answer += ", and a goal." if arena.goal is not None else "."
    return Account(arena, arena.title or "Arena", answer=answer)


def robot_account(robot: Robot, about: About) -> Account:
    """Card of a robot in a notebook."""
    drive = robot.drive
    answer = "One actuator drives every leg; the motion follows from the springs."
    facts = (
        *_robot_facts(robot),
        Fact("Legs", ", ".join(leg.name for leg in robot.legs)),
        Fact("Drive", f"{amount(drive.amplitude, 'm')} in {amount(drive.period, 's')}"),
        Fact("Antennas", ", ".join(one.name for one in robot.antennas)),
    )
    return Account(robot, robot.title or "Robot", answer=answer, facts=facts)


def _robot_facts(robot: Robot, level: parts.Level = CARD) -> list[Fact]:
    amounts = ("Mass", robot.mass, "kg"), ("Weight", robot.weight, "N"), ("u_max", robot.u_max, "m")
    return [Fact(label, amount(value, unit), level) for label, value, unit in amounts]


ROBOT: Schema = (
    *base.read_off((*keys(title=str, mass="g", weight="N", u_max="mm"), PARAMETERS), "robot"),
    Quantity("prediction", holds=_PREDICTION, read=lambda prediction: prediction),
)


def prediction_account(prediction: Prediction, about: About) -> Account:
    """Motion, gaits, margins and drive requirements of a robot, predicted by statics."""
    robot, legs = prediction.robot, prediction.legs
    facts = (
        *_robot_facts(robot, TERMINAL),
        Fact("Drive requirements", lambda: _drive_needs(prediction.drive_needs), TERMINAL),
        Fact("Foot depth", lambda: depth_words(robot, prediction.known_depths), TERMINAL),
        assumed_fact(robot),
    )
    gaits = "Margin: smallest force on a cell that changes the gait. Uncertainty: of this force."
    pushes = "Gain: advance of the body in a step. The push ends at the largest drag of the floor."
    flips = "Displacements of the anchor at which the gait of the leg changes."
    motion = f"{prediction.motion.value}: d/u_max {prediction.advance:z.2f}"
    answer = f"{motion} and {turn_words(prediction.turn)} per cycle"
    title, origin = robot.title or "A robot", "Predicted by statics, without simulation."
    sections = {
        "The robot": (
            Picture("robot", "The robot from the side and from above"),
            Picture("prediction", "The gait that statics predicts"),
        ),
        "Predicted gaits": RecordTable(_LEG, recorded(_LEG, legs), gaits, more="legs", level=CARD),
        "Gait changes by antennas": _of_legs(_FLIP, "flips", flips),
        "Pushes": _of_legs(_PUSH, "pushes", pushes),
        **parameter_section(robot),
        "Assumptions": parts.Notes(prediction.assumptions, FULL),
    }
    doubts = [
        f"{leg.name} may also perform {' or '.join(leg.alternatives or [leg.nearest])}."
        for leg in legs
        if leg.near_boundary
    ]
    soft = [f"{prediction.too_soft}."] if prediction.too_soft else []
    warnings = (
        parts.Warned("Too close to call", "Statics cannot determine these gaits.", doubts),
        parts.Warned("Soft drive", "The stiffness of the drive changes the gait.", soft),
    )
    return Account(prediction, title, "robot/1", answer, facts, sections, warnings, origin)


def assumed_ranges_account(found: "AssumedRanges", about: About) -> Account:
    """Range of every assumed number of a robot in which its gait stays."""
    ended = sum(bool(one.below or one.above) for one in found.ranges)
    gaits = " | ".join(dict.fromkeys(gait or "none" for gait in found.gaits))
    answer = f"{gaits} in all ranges of {counted(len(found.ranges), 'assumed number')}"
    answer += f"; {ended} of these end within the values tried"
    explained = (
        "Each number is changed alone, from its value on, until a leg has another gait in the "
        "simulation; the states just outside are in the last two columns. Without states, the gait "
        "stayed at every value tried."
    )
    sections = {"Ranges": RecordTable(_RANGE, "ranges", explained, more="numbers", level=CARD)}
    title = f"{found.robot.title or 'A robot'}, ranges of the assumed numbers"
    return Account(found, title, "ranges/1", answer, (), sections, packages=["mujoco"])


def _of_legs(columns: Schema, key: str, about: str) -> RecordTable:
    """Table of the pushes or of the gait changes of all legs."""

    def rows(prediction: Row) -> list[Row]:
        return [{"leg": leg["name"], **one} for leg in prediction["legs"] for one in leg[key]]

    return RecordTable((Quantity("leg", head="leg"), *columns), "prediction", about, pick=rows)


def _drive_needs(needs: DriveNeeds) -> str:
    """Forces and stiffness that the gait requires of the motor."""
    enough = f"{number(needs.stiffness, 3)} N/m or more" if needs.stiffness else "any stiffness"
    return f"{number(needs.push, 3)} N loading, {number(needs.pull, 3)} N unloading, {enough}"


def turn_words(turn: float) -> str:
    """A rotation [rad], in degrees to the left."""
    return f"{math.degrees(turn):z.1f}° to the left"


def depth_words(robot: Robot, depths: Sequence[tuple[float, float] | None]) -> str:
    """Depth of the feet, and the depths [m] between which each leg keeps its gait."""
    each = [
        f"{leg.name} {base.to_unit(one[0], 'mm'):.2f} to {base.to_unit(one[1], 'mm'):.2f} mm"
        if one[0] < one[1]
        else f"{leg.name} uncertain at this depth"
        for leg, one in zip(robot.legs, depths, strict=True)
        if one is not None
    ]
    depth = f"{amount(robot.foot.below, 'm')} below the supports"
    return "; the predicted gait stays: ".join([depth] + [", ".join(each)] * bool(each))


def assumed_fact(robot: Robot) -> Fact:
    """Count of the assumed numbers of a robot."""
    sources = [one.source for one in files.provenance(robot)]
    return Fact("Assumed numbers", f"{sources.count('assumed')} of {len(sources)}", TERMINAL)


def parameter_section(robot: Robot, level: parts.Level = FULL) -> parts.Sections:
    """Every number of a robot with its source."""
    about = "Every number with its source; its key is that of the design file."
    rows = recorded(PARAMETER, files.provenance(robot))
    return {"Parameters": RecordTable(PARAMETER, rows, about, level=level)}
