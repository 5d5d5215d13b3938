"""A hopper from the table [hopper] of a chain's design file, and the text of such a table."""

from typing import Any

from stepwell.files.schema import hopper as schema
from stepwell.files.schema.keys import fields, table_lines
from stepwell.mechanism import Chain
from stepwell.robot import Actuator, Hopper, Springs

_PARTS = {"springs": Springs, "actuator": Actuator}


def hopper_of(keys: schema.HopperKeys, chain: Chain, problems: list[str]) -> Hopper | None:
    """The hopper of a file; None with a line added to `problems` for each impossible value."""
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
    tables = {"springs": schema.SpringsKeys, "actuator": schema.ActuatorKeys}
    for name, table in tables.items():
        lines += ["", f"[hopper.{name}]", *table_lines(table, getattr(hopper, name))]
    return "\n".join(lines) + "\n"
