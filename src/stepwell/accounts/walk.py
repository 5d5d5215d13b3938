"""A simulated walk: how far a robot goes and turns in a cycle, and against statics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

from stepwell.accounts.account import (
    Account,
    Fact,
    Level,
    Motion,
    Notes,
    Picture,
    Row,
    Section,
    Table,
    Warned,
)
from stepwell.accounts.assumptions import simulation_assumptions
from stepwell.accounts.head import About
from stepwell.accounts.robot import (
    FEET,
    PARAMETERS,
    SOURCES,
    assumed,
    depth_words,
    parameter_section,
    turn_words,
)
from stepwell.accounts.shape import Shape
from stepwell.base import (
    Column,
    Quantity,
    Schema,
    amount,
    counted,
    number,
    read_off,
    record,
    rows_of,
)

if TYPE_CHECKING:
    from stepwell.robot import Arena
    from stepwell.simulation import Trial, Walk


_SETTINGS: Schema = (
    Quantity("time_step", "ms"),
    Quantity("contact_time", "ms"),
    Quantity("integrator", read=lambda settings: str(settings.integrator)),
    Quantity("linkage", read=lambda settings: str(settings.linkage)),
)
# Of every run, on a bare floor and among obstacles.
WALKED: Schema = (
    Quantity("title", read="robot.title"),
    Quantity("cycles", holds=int),
    Quantity("period", "s", read="robot.drive.period"),
    Quantity("duration", "s"),
    Quantity("distance", "mm"),
    Quantity("work", "mJ"),
    Quantity("weight", "N", read="robot.weight"),
    Quantity("cost_of_transport", holds=float),
    Quantity("stopped"),
    Quantity("simulation", holds=_SETTINGS, read="settings"),
    *read_off((PARAMETERS,), "robot"),
)
_CYCLES: Schema = (
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f", holds=[float]),
    Quantity("sideways", "over_u_max", "to the left", form="z.3f", holds=[float]),
    Quantity("turn", "deg", "turn to the left", form="z.1f", holds=[float]),
)
_LEG: Schema = (
    Quantity("name", head="leg"),
    Quantity("gaits", holds=[str]),
    Quantity("predicted_gait", missing=True),
    Quantity("slip", "mm"),
    FEET,
)


class _Leg(NamedTuple):
    name: str
    gaits: tuple[str, ...]
    predicted_gait: str | None
    slip: float
    feet: tuple[float, float] | None


def _legs(walk: Walk) -> list[_Leg]:
    names, gaits = zip(*walk.gaits.items(), strict=True)
    predicted = walk.comparison.predicted or (None,) * len(names)
    found = zip(names, gaits, predicted, walk.slip, walk.comparison.depths, strict=True)
    return [_Leg(*one) for one in found]


def _mean(walk: Walk) -> Trial:
    from stepwell.simulation import Trial

    return Trial.of(walk)


def walk_schema(_shape: Shape | None = None) -> Schema:
    """What is reported of a walk."""
    return (
        *WALKED,
        Quantity("mean_advance", "over_u_max", read=lambda walk: _mean(walk).advance),
        Quantity("mean_turn", "deg", read=lambda walk: _mean(walk).turn),
        Quantity("work_per_cycle", "mJ", read=lambda walk: _mean(walk).work),
        Quantity("u_max", "mm", read="robot.u_max"),
        *_CYCLES,
        Quantity("foot", "mm", read="robot.foot.below"),
        Quantity("as_predicted", read="comparison.same", holds=bool, missing=True),
        Quantity("comparison", read="comparison.text"),
        Quantity("legs", holds=[_LEG], read=_legs),
    )


def walk_account(walk: Walk, about: About | None = None) -> Account:
    """What is reported of a walk."""
    robot, mean = walk.robot, _mean(walk)
    title = robot.title or "A walk"
    cycles = f"{counted(walk.cycles, 'cycle')} of {amount(robot.drive.period, 's')}"
    after = " after the first" if walk.cycles > 1 else ""
    made = Account(
        walk,
        kind="walk/1",
        schema=walk_schema(),
        title=title,
        origin="Simulated on a flat floor." if walk.arena is None else simulated_in(walk.arena),
        answer=f"Walked {amount(walk.distance, 'm')} in {cycles}",
        about=about or About(robot),
        packages=("mujoco",),
        facts=(
            Fact("Duration", amount(walk.duration, "s")),
            Fact("Advance per cycle", f"d/u_max {mean.advance:z.3f}{after}" * bool(walk.cycles)),
            Fact("Turn per cycle", f"{turn_words(mean.turn)}{after}" * bool(walk.cycles)),
            Fact("u_max", amount(robot.u_max, "m"), Level.TERMINAL),
            Fact("Work per cycle", amount(mean.work, "J") * bool(walk.cycles), Level.TERMINAL),
            transport(walk),
            Fact("Comparison with statics", lambda: walk.comparison.text, Level.TERMINAL),
            Fact("Foot depth", lambda: depth_words(robot, walk.comparison.depths), Level.TERMINAL),
            assumed(robot),
        ),
        warnings=(stopped_early(walk),),
        sections=(
            Section("Motion", [Motion(title)]),
            Section(
                "Path, gait and contacts",
                [
                    Picture("trajectory", "Path from above, and advance and turn of each cycle"),
                    Picture("gait", "Travels and states of the cells of every leg"),
                    Picture("contacts", "Contacts, actuator force and work"),
                ],
            ),
            Section(
                "Gaits",
                [
                    Table(
                        (_LEG[0], *_GAITS),
                        lambda: _gaits(made.record["legs"]),
                        "The states of the cells in a cycle, and how far the foot slips.",
                        most=None,
                        more="gaits",
                    )
                ],
            ),
            Section(
                "Cycles",
                [
                    Table(
                        (_CYCLE, *_CYCLES),
                        lambda: _cycles(walk),
                        "d/u_max is the advance over the largest step of the legs.",
                        more="cycles",
                        level=Level.CARD,
                    )
                ],
            ),
            parameter_section(robot),
            Section("Assumptions", [Notes(simulation_assumptions(walk), Level.PAGE)]),
        ),
        hints=(SOURCES,),
    )
    return made


def simulated_in(arena: Arena) -> str:
    """The arena of a run, in a sentence."""
    return f"Simulated in the arena: {arena.title or 'without a name'}."


def transport(walk: Walk, level: Level = Level.CARD) -> Fact:
    """The cost of transport; none of a robot that got nowhere."""
    cost = walk.cost_of_transport
    known = f"{number(cost, 3)} (work over weight and distance)" if math.isfinite(cost) else ""
    return Fact("Cost of transport", known, level)


def stopped_early(walk: Walk) -> Warned:
    """The warning of a run that did not go on to its end."""
    stopped = [walk.stopped] if walk.stopped else []
    return Warned("Stopped early", "The simulation ended before its time.", stopped)


_CYCLE = Column("cycle", lambda row: str(row["cycle"]), True)
_GAITS = (
    Quantity("cycles", head="cycles"),
    Quantity("states", head="states"),
    Quantity("slip", "mm", "slip per cycle", form=3),
)


def _cycles(walk: Walk) -> list[Row]:
    rows = rows_of(record(_CYCLES, walk))
    return [{"cycle": k, **row} for k, row in enumerate(rows, 1)]


def _gaits(legs: Sequence[Row]) -> list[Row]:
    """Equal gaits that follow each other in one row: their cycles from 1, and the gait."""
    found: list[Row] = []
    for leg in legs:
        first = 1
        for gait, same in groupby(leg["gaits"]):
            last = first + len(list(same)) - 1
            cycles = f"{first}" if first == last else f"{first} to {last}"
            found.append({**leg, "cycles": cycles, "states": gait or "none"})
            first = last + 1
    return found
