"""Behaviours from a file: the table of contacts and motions, the robot, and the choice."""

import os
from decimal import Decimal
from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator

from stepwell.design import BandType
from stepwell.files import design
from stepwell.files.machine import named_text
from stepwell.files.schema import keys, robot as robot_keys, wording
from stepwell.files.schema.chain import Stiffness
from stepwell.files.text import DesignError, did_you_mean, packaged, parsed
from stepwell.robot import Action, BehaviourRow, Robot, RobotBehaviour, RobotChoice

_EMPTY = 'is empty: a behaviour has rows, as in row = [{ contact = "free", motion = "forward" }].'


def _motion(value: Any) -> str:
    known = [str(action) for action in Action]
    if value not in known:
        near = f" {did_you_mean(value, known)}" if isinstance(value, str) else ""
        keys.refuse(f"must be one of {', '.join(map(repr, known))}.{near}")
    return value


def _counts(value: Any) -> tuple[int, ...]:
    if not isinstance(value, list) or not value or not all(type(n) is int for n in value):
        keys.refuse("must be a list of whole numbers, as in [1, 2].")
    if not all(1 <= n <= 9 for n in value):
        keys.refuse("must be from 1 to 9 bands.")
    return tuple(value)


def _lengths(value: Any) -> tuple[Decimal, ...]:
    numbers = keys.lengths(value, None, "must be a list of lengths in mm, as in [2, 4].")
    if not 1 <= len(numbers) <= 20 or not all(0 <= n <= 1000 for n in numbers):
        keys.refuse("must be from 1 to 20 lengths from 0 to 1000 mm.")
    return numbers


def _whole(value: Any) -> int:
    if type(value) is not int or not 1 <= value <= 360:
        keys.refuse("must be a whole number from 1 to 360.")
    return value


Motion = Annotated[str, PlainValidator(_motion)]
Counts = Annotated[tuple[int, ...], PlainValidator(_counts)]
Lengths = Annotated[tuple[Decimal, ...], PlainValidator(_lengths)]
Whole = Annotated[int, PlainValidator(_whole)]


class RowKeys(keys.Keys):
    """A row of the table."""

    contact: keys.Line
    motion: Motion


class PackKeys(keys.Keys):
    """A type of band in the pack."""

    stiffness_N_per_m: Stiffness
    rest_length_mm: robot_keys.Friction


class ChoiceKeys(keys.Keys):
    """Numbers from which the compiler chooses."""

    pitch_mm: robot_keys.Size | None = None
    x_mm: keys.Point | None = None
    y_mm: keys.Point | None = None
    band: Annotated[tuple[PackKeys, ...], keys.at_most("bands")] = ()
    inner_bands: Counts | None = None
    outer_bands: Counts | None = None
    below_mm: Lengths | None = None
    moves_mm: Lengths | None = None
    directions: Whole | None = None


class BehaviourKeys(keys.Keys):
    """A whole behaviour."""

    title: keys.Line = ""
    robot: keys.Line = "robot-antennas"
    row: Annotated[tuple[RowKeys, ...], keys.at_most("antennas")]
    choice: ChoiceKeys = ChoiceKeys()


def behaviours() -> dict[str, str]:
    """Titles of the behaviours in the package, by name."""
    every = packaged("behaviours").items()
    return {name: loads_behaviour(text, name).title for name, text in every}


def behaviour_text(behaviour: str | os.PathLike[str]) -> str:
    """Text of the file of a behaviour, unchecked; all else as for `load_behaviour`."""
    return named_text("behaviour", behaviour)


def load_behaviour(behaviour: str | os.PathLike[str]) -> RobotBehaviour:
    """The behaviour of that name or in a file, with its robot, in SI.

    Args:
        behaviour: a name that `behaviours` lists, such as "turn-away"; or a TOML file with the
            keys of docs/how-to/compile.md. Its robot is the name of a preset, or a file, relative
            to the folder of the behaviour.

    Raises:
        DesignError: the file is missing or invalid; a line for every problem.
    """
    folder = os.fspath(Path(behaviour).parent)
    return loads_behaviour(behaviour_text(behaviour), os.fspath(behaviour), folder)


def loads_behaviour(text: str, name: str = "behaviour", folder: str = ".") -> RobotBehaviour:
    """The behaviour in a text; all else as for `load_behaviour`."""
    table = wording.checked(BehaviourKeys, parsed(text, name, _EMPTY), name)
    rows = [BehaviourRow(one.contact, Action(one.motion)) for one in table.row]
    try:
        choice = _choice(table.choice)
        return RobotBehaviour(rows, _robot(table.robot, folder), choice, table.title)
    except DesignError:
        raise
    except ValueError as error:
        raise DesignError(name, str(error).split("\n")) from None


def _robot(name: str, folder: str) -> Robot:
    known = name in design.presets()
    text = f"preset:{name}" if known else os.path.join(folder, name)
    return design.load(text if not name.startswith("preset:") else name).robot


def _choice(table: ChoiceKeys) -> RobotChoice:
    values = keys.fields(table, left_out=["x_mm", "y_mm", "band"])
    for key, names in (("x_mm", ("left", "right")), ("y_mm", ("bottom", "top"))):
        if (ends := getattr(table, key)) is not None:
            values |= dict(zip(names, keys.si(key, ends), strict=True))
    bands = [BandType(**keys.fields(one)) for one in table.band]
    return RobotChoice(**values, bands=bands)
