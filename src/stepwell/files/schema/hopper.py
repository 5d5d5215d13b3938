"""The keys of the table [hopper] of a design file with their values and units."""

from __future__ import annotations

from decimal import Decimal
from typing import Annotated, Any

from pydantic import PlainValidator

from stepwell.files.schema import keys
from stepwell.files.text import did_you_mean

TASKS = ("jump", "throw", "strike")


def _task(value: Any) -> str:
    if value not in TASKS:
        near = f" {did_you_mean(value, TASKS)}" if isinstance(value, str) else ""
        keys.refuse(f"must be one of {', '.join(map(repr, TASKS))}.{near}")
    return value


def _count(value: Any) -> int:
    if type(value) is not int or not 1 <= value <= 10**6:
        keys.refuse("must be a whole number of 1 or more.")
    return value


Size = Annotated[Decimal, keys.above_zero("1e-6", "1e6")]
Mass = Annotated[Decimal, keys.above_zero("1e-6", "1e9")]
Number = Annotated[Decimal, keys.bounded("0", "1e9", ">= 0 (up to 1e9)")]
Above = Annotated[Decimal, keys.above_zero("1e-9", "1e9")]
Stretch = Annotated[
    Decimal, keys.bounded("1.001", "100", "> 1, a length over rest length (to 100)")
]
Percent = Annotated[Decimal, keys.bounded("0", "99.9")]
Tilt = Annotated[Decimal, keys.bounded("0", "89")]
TaskName = Annotated[str, PlainValidator(_task)]
Count = Annotated[int, PlainValidator(_count)]


class SpringsKeys(keys.Keys):
    """Springs of all cells together."""

    mass_g: Mass | None = None
    stretch: Stretch | None = None
    loss_percent: Percent | None = None
    origin: keys.Line | None = None


class ActuatorKeys(keys.Keys):
    """The linear actuator between body and rod."""

    force_N: Above | None = None
    speed_mm_per_s: Size | None = None
    stiffness_N_per_m: Above | None = None


class HopperKeys(keys.Keys):
    """The masses on a chain, and the task of its snap."""

    task: TaskName | None = None
    body_mass_g: Mass
    foot_mass_g: Mass
    foot_after: Count | None = None
    copies: Count | None = None
    ball_mass_g: Mass | None = None
    block_mass_g: Mass | None = None
    damping_N_s_per_m: Number | None = None
    tilt_deg: Tilt | None = None
    foot_length_mm: Size | None = None
    height_mm: Size | None = None
    body_size_mm: Size | None = None
    friction: Number | None = None
    gravity_m_per_s2: Number | None = None
    springs: SpringsKeys = SpringsKeys()
    actuator: ActuatorKeys = ActuatorKeys()
