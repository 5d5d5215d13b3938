"""A hopper from the table [hopper] of a chain's design file, and the text of such a table."""

from typing import Any

from stepwell.base import to_unit
from stepwell.files.robot_parameters import RobotParameter
from stepwell.files.schema import hopper as schema
from stepwell.files.schema.keys import Keys, field_of, fields, table_lines, unit_of
from stepwell.files.schema.robot import ASSUMED
from stepwell.mechanism import Chain
from stepwell.robot import Actuator, Hopper, Springs

_PARTS = {"springs": Springs, "actuator": Actuator}
_TABLES: dict[str, type[Keys]] = {
    "": schema.HopperKeys,
    "springs": schema.SpringsKeys,
    "actuator": schema.ActuatorKeys,
}


def hopper_of(keys: schema.HopperKeys, chain: Chain, problems: list[str]) -> Hopper | None:
    """The hopper of a file.

    Args:
        keys: of the table [hopper].
        chain: of the same file, whose title the hopper takes.
        problems: a line is added for each impossible value; then the result is None.
    """
    values: dict[str, Any] = fields(keys, left_out=_PARTS)
    for name, make in _PARTS.items():
        try:
            values[name] = make(**fields(getattr(keys, name)))
        except ValueError as error:
            problems.append(f"hopper.{name}: {error}")
    if problems:
        return None
    try:
        return Hopper(chain, title=chain.title, **values)
    except ValueError as error:
        problems += [f"hopper: {line}" for line in str(error).split("\n")]
        return None


def hopper_text(hopper: Hopper) -> str:
    """Text of the table [hopper], to follow the text of its chain."""
    lines = ["[hopper]", *table_lines(schema.HopperKeys, hopper, left_out=_PARTS)]
    for name in _PARTS:
        lines += ["", f"[hopper.{name}]", *table_lines(_TABLES[name], getattr(hopper, name))]
    return "\n".join(lines) + "\n"


def hopper_parameters(hopper: Hopper) -> tuple[RobotParameter, ...]:
    """Every number of the table [hopper], also defaults; all of them are assumed."""
    found: list[RobotParameter] = []
    for name, table in _TABLES.items():
        value = getattr(hopper, name) if name else hopper
        for key in table.model_fields:
            number = getattr(value, field_of(key))
            if isinstance(number, int | float):
                unit = unit_of(key)
                path = ".".join(filter(None, ("hopper", name, key)))
                shown = to_unit(float(number), unit) if unit else float(number)
                found.append(RobotParameter(path, (shown,), unit, ASSUMED))
    return tuple(found)
