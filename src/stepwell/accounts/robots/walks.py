"""Simulated walks on a flat floor and in an arena, sweeps over robots, one walk by time step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby
from typing import TYPE_CHECKING, Any

from stepwell import base, robot as robots
from stepwell.accounts import parts
from stepwell.accounts.head import About, Row, digest_of, keys
from stepwell.accounts.parts import CARD, FULL, TERMINAL, Account, Fact, Picture, RecordTable
from stepwell.accounts.robots import robot as of_robot
from stepwell.accounts.words import simulation_assumptions
from stepwell.base import Column, Quantity, Schema, amount, counted, number

if TYPE_CHECKING:
    from stepwell.simulation import Convergence, Maze, Sweep, Trial, Walk

_SETTINGS: Schema = (
    *keys(time_step="ms", contact_time="ms", integrator=(str, lambda one: str(one.integrator))),
    *keys(linkage=(str, lambda settings: str(settings.linkage))),
)
# Of every run, on a flat floor and among obstacles.
_WALKED: Schema = (
    *keys(title=(str, "robot.title"), cycles=int, period=("s", "robot.drive.period")),
    *keys(duration="s", distance="mm", work="mJ", weight=("N", "robot.weight")),
    *keys(cost_of_transport=float, stopped=str, simulation=(_SETTINGS, "settings")),
    *base.read_off((of_robot.PARAMETERS,), "robot"),
)
_CYCLES: Schema = (
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f", holds=[float]),
    Quantity("sideways", "over_u_max", "to the left", form="z.3f", holds=[float]),
    Quantity("turn", "deg", "turn to the left", form="z.1f", holds=[float]),
)
_LEG = (*keys(name=str, gaits=[str], predicted_gait=str | None, slip="mm"), of_robot.FEET)
_GAITS = (
    Quantity("name", head="leg"),
    Quantity("cycles", head="cycles"),
    Quantity("states", head="states"),
    Quantity("slip", "mm", "slip per cycle", form=3),
)
_TOUCHED: Schema = (
    Quantity("obstacle", head="obstacle", read=lambda touch: touch[0]),
    Quantity("time", "s", "first touched", read=lambda touch: touch[1], none="never"),
)
_CONTACT: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("begin", "s", "from"),
    Quantity("end", "s", "to"),
    Quantity("swing", "deg", "swing", form=3),
    Quantity("moved", "mm", "anchor moved", form=3),
)
_CHANGE: Schema = (
    Quantity("time", "s", "from"),
    Quantity("leg", head="leg"),
    Quantity("before", head="before", form=lambda gait: gait or "none"),
    Quantity("after", head="after", form=lambda gait: gait or "none"),
)
_TRIAL: Schema = (Quantity("values", holds=[float]), *base.read_off(robots.TRIAL, "trial"))
_TIME_STEP: Schema = (
    Quantity("time_step", "ms", "time step"),
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f"),
    Quantity("turn", "deg", "turn", form="z.1f"),
    Quantity("forces_off", "percent", read="off", form=".2f"),
    Quantity("jumps", "percent", "jumps", form=".1f"),
)
_DEVIATION = Column("force deviation [% of weight]", _TIME_STEP[3].cell, True)
CONVERGENCE = keys(title=(str, "robot.title"), time_steps=([_TIME_STEP], "rows"))


def _legs(walk: Walk) -> Sequence[Row]:
    gaits, statics = walk.gaits, walk.comparison
    predicted = statics.predicted or [None] * len(gaits)
    columns = (gaits, gaits.values(), predicted, walk.slip, statics.depths)
    return base.rows_of(dict(zip((one.name for one in _LEG), columns, strict=True)))


def _trial(walk: Walk) -> Trial:
    # The schemas of walks can be read without the simulator.
    from stepwell.simulation import Trial

    return Trial.of(walk)


# A prediction takes seconds, and the record, the screen and the page need it.
@lru_cache(maxsize=8)
def _advance(robot: robots.Robot) -> float:
    return robot.predict().advance


def _predicted(walk: Walk) -> float | None:
    """Advance per cycle by statics, as d/u_max, where the walk has two cycles to compare."""
    compared = walk.cycles >= 2 and walk.comparison.predicted
    return _advance(walk.robot) if compared else None


WALK: Schema = (
    *_WALKED,
    *keys(predicted_advance=("over_u_max", _predicted)),
    *keys(mean_advance=("over_u_max", lambda walk: _trial(walk).advance)),
    *keys(mean_turn=("deg", lambda walk: _trial(walk).turn)),
    *keys(work_per_cycle=("mJ", lambda walk: _trial(walk).work), u_max=("mm", "robot.u_max")),
    *_CYCLES,
    *keys(foot=("mm", "robot.foot.below")),
    *keys(as_predicted=(bool | None, "comparison.same"), comparison=(str, "comparison.text")),
    Quantity("legs", holds=[_LEG], read=_legs),
)


def walk_account(walk: Walk, about: About) -> Account:
    """Advance, turn, work, gaits and contacts of a simulated walk."""
    robot, mean = walk.robot, _trial(walk)
    title = robot.title or "A walk"
    done = number(walk.duration / robot.drive.period)
    cycles = f"{done} cycle{'s' * (done != '1')} of {amount(robot.drive.period, 's')}"
    after = " after the first" if walk.cycles > 1 else ""
    any_cycle = bool(walk.cycles)
    facts = (
        Fact("Duration", amount(walk.duration, "s")),
        Fact("Advance per cycle", f"d/u_max {mean.advance:z.3f}{after}" * any_cycle),
        Fact("Turn per cycle", f"{of_robot.turn_words(mean.turn)}{after}" * any_cycle),
        Fact("u_max", amount(robot.u_max, "m"), TERMINAL),
        Fact("Work per cycle", amount(mean.work, "J") * any_cycle, TERMINAL),
        _transport_fact(walk, CARD),
        Fact("Comparison with statics", lambda: _comparison(walk, mean.advance), TERMINAL),
        Fact("Foot depth", lambda: of_robot.depth_words(robot, walk.comparison.depths), TERMINAL),
        of_robot.assumed_fact(robot),
    )
    each = base.rows_of({"cycle": range(1, len(walk.advance) + 1), **base.record(_CYCLES, walk)})
    gaits = "States of the cells in a cycle, and slip of the foot."
    advance = "d/u_max is the advance over the largest step of the legs."
    columns = (Quantity("cycle", head="cycle", left=False), *_CYCLES)
    sections = {
        "Motion": parts.Replay(title),
        "Path, gait and contacts": (
            Picture("trajectory", "Path from above, and advance and turn of each cycle"),
            Picture("gait", "Travels and states of the cells of every leg"),
            Picture("contacts", "Contacts, actuator force and work"),
        ),
        "Gaits": RecordTable(_GAITS, "legs", gaits, pick=_gait_rows),
        "Cycles": RecordTable(columns, lambda: each, advance, more="cycles", level=CARD),
        **_input_sections(walk),
    }
    answer = f"Walked {amount(walk.distance, 'm')} in {cycles}"
    origin = "Simulated on a flat floor." if walk.arena is None else _simulated_in(walk.arena.title)
    warned = _stopped_early("The simulation", walk.stopped)
    options = _simulated(about)
    return Account(walk, title, "walk/1", answer, facts, sections, warned, origin, **options)


def _simulated(about: About, *hints: str) -> dict[str, Any]:
    """Options of the account of a simulation."""
    show = f"`stepwell robot show {about.source or 'ROBOT'} --full`"
    sources = f"{show} lists every number with its source."
    return {"hints": [*hints, sources], "packages": ["mujoco"]}


def _comparison(walk: Walk, advance: float) -> str:
    """Comparison of the gaits with statics, and of the advance after the first cycle."""
    predicted, text = _predicted(walk), walk.comparison.text
    if predicted is None:
        return text
    return f"d/u_max {advance:z.3f}, predicted {predicted:z.2f}; {text}"


def _input_sections(walk: Walk) -> parts.Sections:
    """Parameters and assumptions of a simulation."""
    assumptions = parts.Notes(simulation_assumptions(walk), FULL)
    return {**of_robot.parameter_section(walk.robot), "Assumptions": assumptions}


def _simulated_in(arena: str) -> str:
    return f"Simulated in the arena: {arena or 'without a name'}."


def _transport_fact(walk: Walk, level: parts.Level) -> Fact:
    """Cost of transport; without text for a robot that did not advance."""
    cost = walk.cost_of_transport
    finite = f"{number(cost, 3)} (work over weight and distance)" if math.isfinite(cost) else ""
    return Fact("Cost of transport", finite, level)


def _stopped_early(what: str, reason: str) -> list[parts.Warned]:
    """Warning of a simulation that stopped for a reason."""
    reasons = [reason] if reason else []
    return [parts.Warned("Stopped early", f"{what} ended before its time.", reasons)]


def _gait_rows(legs: Sequence[Row]) -> list[Row]:
    """Consecutive cycles of equal gait as one row."""
    rows: list[Row] = []
    for leg in legs:
        first = 1
        for gait, same in groupby(leg["gaits"]):
            last = first + len(list(same)) - 1
            cycles = f"{first}" if first == last else f"{first} to {last}"
            rows.append({**leg, "cycles": cycles, "states": gait or "none"})
            first = last + 1
    return rows


MAZE: Schema = (
    *keys(arena_sha256=(str | None, lambda maze: digest_of(maze.arena))),
    *keys(start_seed=int | None, layout_seed=int | None),
    *base.read_off(_WALKED, "walk"),
    *keys(arena=(str, "arena.title")),
    Quantity("start", "mm", read="arena.start", holds=[float]),
    Quantity("heading", "deg", read="arena.heading"),
    Quantity("end", "mm", holds=[float], missing=True),
    *keys(outcome=str, limit="s"),
    *keys(antennas=([keys(name=str, leg=str, connected=bool)], "walk.robot.antennas")),
    *keys(touched=([_TOUCHED], lambda maze: maze.touched.items()), contacts=[_CONTACT]),
    *keys(changes=[_CHANGE]),
)


def maze_account(maze: Maze, about: About) -> Account:
    """Path of a robot through an arena, its contacts and changes of gait."""
    walk, antennas = maze.walk, maze.walk.robot.antennas
    title = walk.robot.title or "A robot in an arena"
    touched = sum(time is not None for time in maze.touched.values())
    # An antenna with a disconnected lever moves no anchor.
    legs = {one.name: one.leg for one in antennas if one.connected}
    leg = Column("reprograms", lambda contact: legs.get(contact["antenna"], "nothing"))
    off = ", ".join(one.name for one in antennas if not one.connected)
    fitted = f"{len(antennas) or 'none'}" + f"; levers disconnected: {off}" * bool(off)
    end = ", ".join(number(base.to_unit(one, "mm")) for one in maze.end or ())
    goal = "; no goal in the arena" * (maze.arena.goal is None)
    late = maze.arena.goal is not None and maze.outcome.name == "TIMED_OUT"
    hints = ["`--limit S` sets the time limit [s]."] * late
    facts = (
        Fact("Arena", maze.arena.title, TERMINAL),
        Fact("Duration", f"{amount(walk.duration, 's')}, limit {amount(maze.limit, 's')}{goal}"),
        Fact("Obstacles touched", f"{touched} of {len(maze.touched)}" * bool(maze.touched)),
        Fact("Antennas", fitted, TERMINAL),
        Fact("Distance", amount(walk.distance, "m"), TERMINAL),
        Fact("Cycles", str(walk.cycles), TERMINAL),
        Fact("End position", f"({end}) mm" * bool(end), TERMINAL),
        _transport_fact(walk, TERMINAL),
        of_robot.assumed_fact(walk.robot),
    )
    touches, contacts = "Time of the first contact.", "Each contact, and the leg that it changes."
    changes = "Start of the first cycle with the new gait."
    sections = {
        "Motion": parts.Replay(title),
        "Path": (
            Picture("maze", "Path from above"),
            Picture("timeline", "Antennas, gaits and obstacles over time"),
        ),
        "Obstacles": RecordTable(_TOUCHED, "touched", touches),
        "Antenna contacts": RecordTable((*_CONTACT, leg), "contacts", contacts),
        "Gait changes": RecordTable(_CHANGE, "changes", changes, more="changes", level=CARD),
        **_input_sections(walk),
    }
    origin, warned = _simulated_in(maze.arena.title), _stopped_early("The simulation", walk.stopped)
    seeds = {name: about.seeds.get(name) for name in ("start_seed", "layout_seed")}
    options = {**_simulated(about, *hints), "given": seeds}
    return Account(maze, title, "maze/1", maze.ending, facts, sections, warned, origin, **options)


def _trials(sweep: Sweep) -> Sequence[Row]:
    values = zip(*sweep.values.values(), strict=True) if sweep.values else [()] * len(sweep.trials)
    return base.rows_of({"values": values, "trial": sweep.trials})


SWEEP = keys(
    keys=([str], lambda sweep: list(sweep.values)),
    arena=(str | None, lambda sweep: sweep.arena or None),
    trials=([_TRIAL], _trials),
)


def sweep_account(sweep: Sweep, about: About) -> Account:
    """Results per cycle of several robots."""
    failed = [one for one in sweep.trials if one.stopped]
    count, completed = counted(len(sweep.trials), "robot"), len(sweep.trials) - len(failed)
    columns: list[Column | Quantity] = [
        Column(key, lambda row, k=k: number(row["values"][k], 6), True)
        for k, key in enumerate(sweep.values)
    ]
    columns += robots.TRIAL
    wide = [Column("reason", lambda row: row["stopped"])] if failed else []
    early = f"{counted(len(failed), 'robot')} stopped early. First reason: "
    sections = {
        "Results": Picture("sweep", "Results per cycle of each robot"),
        "Robots": RecordTable(columns, "trials", "", wide, more="robots", level=CARD),
    }
    answer = f"{completed} of {counted(len(sweep.trials), 'run')} completed"
    where = f" {_simulated_in(sweep.arena)}" if sweep.arena else ""
    origin = f"Varied: {', '.join(sweep.values) or 'nothing'}.{where}"
    reason = f"{early}{failed[0].stopped}" if failed else ""
    warned = _stopped_early("The simulation of some robots", reason)
    options: dict[str, Any] = {"seed": about.seeds.get("values"), "packages": ["mujoco"]}
    return Account(sweep, count, "sweep/1", answer, (), sections, warned, origin, **options)


def convergence_account(convergence: Convergence, about: About) -> Account:
    """Deviations of a walk between several time steps."""
    rows = convergence.rows
    steps = ", ".join(number(base.to_unit(row.time_step, "ms")) for row in rows)
    advance, off = [row.advance for row in rows], max(row.off for row in rows) * 100
    columns = (*_TIME_STEP[:3], _DEVIATION, _TIME_STEP[4])
    answer = (
        f"d/u_max {min(advance):.3f} to {max(advance):.3f} at time steps of {steps} ms; ground "
        f"reaction forces deviate by at most {off:.2f} % of the weight"
    )
    defined = (
        "Force deviation: root mean square over samples of the ground reaction forces against "
        "those at the smallest time step. Jumps: fraction of the steps in which a ground reaction "
        "force changes by more than a fifth."
    )
    sections = {
        "Time steps": RecordTable(columns, "time_steps", more="time steps", level=CARD),
        "Definitions": parts.Text(defined),
    }
    title = f"{convergence.robot.title or 'A robot'}, by time step"
    return Account(convergence, title, "convergence/1", answer, (), sections, packages=["mujoco"])
