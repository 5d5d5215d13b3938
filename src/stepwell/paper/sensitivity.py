"""Sensitivity of the results about the robot to every assumed number."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell import base, files
from stepwell.paper.walking import BACKWARD, FORWARD, STANDS_STILL, TURN_DEG, robot
from stepwell.robot import Robot

if TYPE_CHECKING:
    from stepwell.simulation import Trial

CYCLES = 4


@dataclass(frozen=True, slots=True, eq=False)
class Effect(base.ByValue):
    """Change of a result with one parameter.

    Args:
        parameter: its name and unit, as "foot friction" or "period [s]".
        low, high: its two values, in that unit.
        at_low, at_high: the result with each; NaN without a result.
    """

    parameter: str
    low: float
    high: float
    at_low: float
    at_high: float

    @property
    def span(self) -> float:
        """Difference between the two results, infinite if one is missing."""
        span = abs(self.at_high - self.at_low)
        return span if math.isfinite(span) else math.inf


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivity(base.ByValue):
    """A result, and its change with each parameter.

    Args:
        result: its name and unit, as "forward: d/u_max"; mathematics between dollar signs.
        nominal: the result with all parameters unchanged.
        effects: in any order.
        target: lower and upper bound of the target, None without one.
    """

    result: str
    nominal: float
    effects: Sequence[Effect]
    target: tuple[float, float] | None = None


class Variation(NamedTuple):
    """An assumed number: its label, its keys, and its two values.

    A key with a minus sign gets the negative value, for the other side of the robot.
    """

    label: str
    keys: tuple[str, ...]
    low: float
    high: float


# By a fifth by default, by a few millimetres for visible dimensions.
VARIATIONS = (
    Variation("mass of the body [g]", ("body.mass_g",), 208, 312),
    Variation("centre of mass, forward [mm]", ("body.centre_mm[0]",), 20, 28),
    Variation("centre of mass, up [mm]", ("body.centre_mm[2]",), -10, 10),
    Variation("rear support, forward [mm]", ("body.supports_mm[0][0]",), -65, -45),
    Variation(
        "front supports, forward [mm]", ("body.supports_mm[1][0]", "body.supports_mm[2][0]"), 34, 42
    ),
    Variation(
        "front supports, sideways [mm]",
        ("body.supports_mm[1][1]", "-body.supports_mm[2][1]"),
        35,
        52,
    ),
    Variation("feet below the supports [mm]", ("foot.below_mm",), 0.72, 1.08),
    Variation("radius of the feet [mm]", ("foot.radius_mm",), 3, 5),
    Variation("mass of a block [g]", ("blocks.mass_g",), 4, 8),
    Variation("mass of the carriage [g]", ("blocks.carriage_g",), 5, 20),
    Variation("damping of a cell [N s/m]", ("blocks.damping_N_s_per_m",), 0.5, 1.5),
    Variation("friction of a cell [N]", ("leg.*.chain.cell.*.friction_N",), 0.0, 0.02),
    Variation("friction of a slider's rail [N]", ("blocks.rail_friction_N",), 0.0, 0.02),
    Variation("friction of the feet", ("floor.foot_friction",), 0.4, 0.6),
    Variation("period of the drive [s]", ("drive.period_s",), 1, 4),
    Variation("stiffness of the drive [N/m]", ("drive.stiffness_N_per_m",), 1000, 4000),
    Variation("feet, forward [mm]", ("leg.*.at_mm[0]",), 4, 12),
    Variation("feet, sideways [mm]", ("leg.left.at_mm[1]", "-leg.right.at_mm[1]"), 52, 63),
)


def _turn(trial: "Trial") -> float:
    return float(np.degrees(trial.turn))


class Result(NamedTuple):
    """A robot, the result read from its walk, its label on an axis, and its target."""

    robot: str
    read: "Callable[[Trial], float]"
    label: str
    centre: float
    half_width: float


RESULTS = (
    Result("forward", attrgetter("advance"), "q_out = 20 mm: d/u_max", FORWARD[0], FORWARD[1]),
    Result("backward", attrgetter("advance"), "q_out = 5 mm: d/u_max", -BACKWARD[0], BACKWARD[1]),
    Result("15", attrgetter("advance"), "q_out = 15 mm: d/u_max", 0.0, STANDS_STILL),
    Result("left", _turn, "one of each: turn [°] a cycle", *TURN_DEG),
)


def changed(design: Robot, variation: Variation, value: float) -> Robot:
    """A robot with one assumed number changed, in the unit of its keys."""
    signs = {key: -1 if key.startswith("-") else 1 for key in variation.keys}
    return files.vary(design, {key.lstrip("-"): sign * value for key, sign in signs.items()})


@cache
def sensitivities() -> tuple[Sensitivity, ...]:
    """Each result with each assumed number, and each number of the simulation, changed alone."""
    from stepwell.simulation import Integrator, Settings, sweep

    coarse = Settings(time_step=2e-3, contact_time=4e-3)
    euler, implicit = (Settings(integrator=one) for one in (Integrator.EULER, Integrator.IMPLICIT))
    numerics = {
        "time step [ms]": {0.5: Settings(time_step=5e-4), 2.0: coarse},
        "time constant of contacts [ms]": {2.0: Settings(), 4.0: Settings(contact_time=4e-3)},
        "integrator: Euler, implicit": {0.0: euler, 1.0: implicit},
    }
    designs = [robot(result.robot) for result in RESULTS]
    ends = [(variation, value) for variation in VARIATIONS for value in variation[2:]]
    varied = [changed(design, *end) for design in designs for end in ends]
    trials = iter(sweep(varied, cycles=CYCLES).trials)
    nominal = sweep(designs, cycles=CYCLES).trials
    stepped = [
        [sweep(designs, cycles=CYCLES, settings=each).trials for each in settings.values()]
        for settings in numerics.values()
    ]
    results: list[Sensitivity] = []
    for k, result in enumerate(RESULTS):
        effects = [
            Effect(one.label, one.low, one.high, *(result.read(next(trials)) for _ in range(2)))
            for one in VARIATIONS
        ]
        for (label, settings), both in zip(numerics.items(), stepped, strict=True):
            effects.append(Effect(label, *settings, *(result.read(each[k]) for each in both)))
        target = (result.centre - result.half_width, result.centre + result.half_width)
        results.append(Sensitivity(result.label, result.read(nominal[k]), effects, target))
    return tuple(results)
