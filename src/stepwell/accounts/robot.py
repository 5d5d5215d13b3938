"""A robot, the gait that statics predicts for it, and the arena that it walks in."""

import math
from collections.abc import Callable, Sequence

from stepwell import base, files
from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, keys, recorded
from stepwell.accounts.parts import CARD, PAGE, TERMINAL, Account, Fact, Picture, RecordTable
from stepwell.base import Column, Quantity, Schema, amount, number
from stepwell.robot import Arena, DriveNeeds, Motion, Prediction, Robot

# Where the sources of a robot's numbers are, for results of its simulation.
SOURCES = "`stepwell robot show` lists every number of a robot with its source."

PARAMETER: Schema = (
    Quantity("key", read="path", head="key"),
    Quantity("values", holds=[float]),
    Quantity("unit", head="unit"),
    Quantity("source", head="source"),
)
PARAMETERS = Quantity("parameters", holds=[PARAMETER], read=files.provenance)
_PUSH: Schema = (
    Quantity("direction", head="while", read=lambda p: "loading" if p.loading else "unloading"),
    *keys(step="mm", gain="mm", load="N"),
    Quantity("drag", "N", "drag", form=3),
    Quantity("largest_drag", "N", "largest drag", form=3, none="any"),
    Quantity("limit", head="then", read="limit.value"),
)
_FLIP: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("displacement", "mm", "anchor moved", form=3),
    *keys(earliest="mm", latest="mm"),
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
_LEG_NAME = Column("leg", lambda row: row["leg"])
_GAIN = Column("gains [mm]", lambda p: f"{p['gain_mm']:.1f} of {p['step_mm']:.1f}", True)
_PUSHES = (_LEG_NAME, _PUSH[0], _GAIN, *_PUSH[4:])
_INTERVAL = Column("interval [mm]", lambda flip: _interval(flip), True)
_FLIPS = (_FLIP[0], _LEG_NAME, _FLIP[1], _INTERVAL, *_FLIP[4:])
# The unit of the values is in the key.
_VALUES = Column("value", lambda row: ", ".join(f"{one:.6g}" for one in row["values"]), True)


def _legs(found: Prediction) -> Sequence[Row]:
    return base.rows_of({"leg": found.legs, "feet": found.known_depths})


_PREDICTION: Schema = (
    *keys(motion=Motion, advance="over_u_max", sideways="over_u_max", turn="deg"),
    *keys(first_advance="over_u_max", too_soft=str, near_boundary=bool),
    *keys(drive_needs=keys(push="N", pull="N", stiffness="N_per_m")),
    *keys(legs=([(*base.read_off(_LEG, "leg"), FEET)], _legs), assumptions=[str]),
)


def arena_account(arena: Arena, about: About) -> Account:
    """What a notebook shows of an arena."""
    answer = (
        f"{base.counted(len(arena.walls), 'wall')} and "
        f"{base.counted(len(arena.cylinders), 'cylinder')}"
        f"{', and a goal' * (arena.goal is not None)}."
    )
    return Account(arena, arena.title or "Arena", answer=answer)


def robot_account(robot: Robot, about: About) -> Account:
    """What a notebook shows of a robot."""
    drive = robot.drive
    answer = "One actuator drives every leg; what it does follows from its springs."
    facts = (
        *_robot_facts(robot),
        Fact("Legs", ", ".join(leg.name for leg in robot.legs)),
        Fact("Drive", f"{amount(drive.amplitude, 'm')} in {amount(drive.period, 's')}"),
        Fact("Antennas", ", ".join(one.name for one in robot.antennas)),
    )
    return Account(robot, robot.title or "Robot", answer=answer, facts=facts)


def _robot_facts(robot: Robot, level: parts.Level = CARD) -> list[Fact]:
    return [
        Fact("Mass", amount(robot.mass, "kg"), level),
        Fact("Weight", amount(robot.weight, "N"), level),
        Fact("u_max", amount(robot.u_max, "m"), level),
    ]


# What is reported of a robot and its prediction.
ROBOT: Schema = (
    *base.read_off((*keys(title=str, mass="g", weight="N", u_max="mm"), PARAMETERS), "robot"),
    Quantity("prediction", holds=_PREDICTION, read=lambda found: found),
)


def prediction_account(found: Prediction, about: About) -> Account:
    """What is reported of a prediction."""
    robot = found.robot
    doubted = "Statics cannot determine which gait these legs have."
    doubts = [
        f"{leg.name} may go {' or '.join(leg.alternatives or [leg.nearest])} as well."
        for leg in found.legs
        if leg.near_boundary
    ]
    soft = [f"{found.too_soft}."] if found.too_soft else []
    facts = (
        *_robot_facts(robot, TERMINAL),
        Fact("Drive requirements", lambda: _needs(found.drive_needs), TERMINAL),
        Fact("Foot depth", lambda: depth_words(robot, found.known_depths), TERMINAL),
        assumed(robot),
    )
    legs = (
        "Margin: the smallest force on one cell that changes the gait. "
        "Uncertainty: the force that the prediction does not know."
    )
    pushes = "How far the body goes of each step, and up to which drag of the floor."
    flips = "How far an antenna moves the anchor before the gait of its leg changes."
    title = robot.title or "A robot"
    answer = (
        f"{found.motion.value}: d/u_max {found.advance:z.2f} and {turn_words(found.turn)} per cycle"
    )
    sections = {
        "The robot": (
            Picture("robot", "The robot from the side and from above"),
            Picture("prediction", "The gait that statics predicts"),
        ),
        "Predicted gaits": RecordTable(
            _LEG, recorded(_LEG, found.legs), legs, most=None, more="legs", level=CARD
        ),
        "Pushes": RecordTable(_PUSHES, "prediction", pushes, most=None, pick=_of_legs("pushes")),
        "Gait changes by antennas": RecordTable(
            _FLIPS, "prediction", flips, most=None, pick=_of_legs("flips")
        ),
        **parameter_section(robot, TERMINAL),
        "Assumptions": parts.Notes(found.assumptions, PAGE),
    }
    warnings = (
        parts.Warned("Too close to call", doubted, doubts),
        parts.Warned("Soft drive", "The stiffness of the drive changes the gait.", soft),
    )
    origin = "Predicted by statics, without simulation."
    return Account(found, title, "robot/1", answer, facts, sections, warnings, origin)


def _of_legs(key: str) -> Callable[[Row], list[Row]]:
    return lambda found: [{"leg": leg["name"], **one} for leg in found["legs"] for one in leg[key]]


def _needs(needs: DriveNeeds) -> str:
    """What a motor must have for the gait."""
    enough = f"{number(needs.stiffness, 3)} N/m or more" if needs.stiffness else "any stiffness"
    return f"{number(needs.push, 3)} N loading, {number(needs.pull, 3)} N unloading, {enough}"


def _interval(flip: Row) -> str:
    earliest, latest = number(flip["earliest_mm"], 3), flip["latest_mm"]
    return f"from {earliest}, or never" if latest is None else f"{earliest} to {number(latest, 3)}"


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
    found = f"{amount(robot.foot.below, 'm')} below the supports"
    return found + (f"; the predicted gait stays: {', '.join(each)}" if each else "")


def assumed(robot: Robot) -> Fact:
    """How many numbers of a robot are assumed."""
    sources = [one.source for one in files.provenance(robot)]
    return Fact("Assumed numbers", f"{sources.count('assumed')} of {len(sources)}", TERMINAL)


def parameter_section(robot: Robot, level: parts.Level = PAGE) -> parts.Sections:
    """Every number of a robot with its source."""
    columns = (PARAMETER[0], _VALUES, *PARAMETER[2:])
    about = "Every number with its source; its key is that of the design file."
    rows = recorded(PARAMETER, files.provenance(robot))
    return {"Parameters": RecordTable(columns, rows, about, most=None, level=level)}
