"""What robots do as plain numbers with the unit in every name, for other programs to read."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stepwell.accounts import head
from stepwell.base import Quantity, Schema, plain, record
from stepwell.files import digest, dumps, provenance
from stepwell.robot import Arena, Prediction, Robot, depths
from stepwell.statics import StaticsError

if TYPE_CHECKING:
    from stepwell.simulation import Convergence, Maze, Sweep, Walk


def _feet(depths: list[float]) -> str:
    return f"{depths[0]:.2f} to {depths[1]:.2f}"


ROBOT: Schema = (
    Quantity("title"),
    Quantity("mass", "g"),
    Quantity("weight", "N"),
    Quantity("u_max", "mm", read=lambda robot: _most(robot)),
    Quantity("parameters", read=lambda robot: _parameters(robot)),
)
PREDICTION: Schema = (
    Quantity("motion"),
    Quantity("advance", "over_u_max"),
    Quantity("sideways", "over_u_max"),
    Quantity("turn", "deg"),
    Quantity("first_advance", "over_u_max"),
    Quantity("too_soft"),
    Quantity("near_boundary"),
)
NEEDS: Schema = (
    Quantity("push", "N"),
    Quantity("pull", "N"),
    Quantity("stiffness", "N_per_m"),
)
PUSH: Schema = (
    Quantity("direction", head="while", read=lambda p: "loading" if p.loading else "unloading"),
    Quantity("step", "mm"),
    Quantity("gain", "mm"),
    Quantity("load", "N"),
    Quantity("drag", "N", "drag", form=3),
    Quantity("largest_drag", "N", "goes on up to", form=3, none="any"),
    Quantity("limit", head="then", read="limit.value"),
)
FLIP: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("displacement", "mm", "anchor moved", form=3),
    Quantity("earliest", "mm", form=3),
    Quantity("latest", "mm", form=3),
    Quantity("swing", "deg", "swing", form=3),
    Quantity("gait", head="then"),
)
PREDICTED: Schema = (
    Quantity("name", head="leg"),
    Quantity("gait", head="states"),
    Quantity("first_gait", head="first cycle"),
    Quantity("advance", "over_u_max", "d/u_max", form=".2f"),
    Quantity("slip", "mm"),
    Quantity("margin", "mN", "margin", form=3, none="over 2000"),
    Quantity("uncertainty", "mN", "unknown", form=3),
    Quantity("nearest", head="past the margin"),
    Quantity("feet", "mm", "feet", form=_feet),
    Quantity("alternatives"),
    Quantity("near_boundary"),
    Quantity("pushes", read=lambda leg: [record(PUSH, push) for push in leg.pushes]),
    Quantity("flips", read=lambda leg: [record(FLIP, flip) for flip in leg.flips]),
)
WALKED: Schema = (
    Quantity("title", read="robot.title"),
    Quantity("cycles"),
    Quantity("period", "s", read="robot.drive.period"),
    Quantity(
        "duration",
        "s",
        read=lambda walk: max(0.0, float(walk.time[-1])) if len(walk.time) else 0.0,
    ),
    Quantity("distance", "mm"),
    Quantity("work", "mJ"),
    Quantity("weight", "N", read="robot.weight"),
    Quantity(
        "cost_of_transport", read=lambda walk: walk.cost_of_transport if len(walk.time) else None
    ),
    Quantity("stopped"),
    Quantity("simulation", read=lambda walk: record(SETTINGS, walk.settings)),
)
SETTINGS: Schema = (
    Quantity("time_step", "ms"),
    Quantity("contact_time", "ms"),
    Quantity("integrator", read=lambda settings: str(settings.integrator)),
    Quantity("linkage", read=lambda settings: str(settings.linkage)),
)
MEAN: Schema = (
    Quantity("mean_advance", "over_u_max", "mean d/u_max", "advance", "z.3f"),
    Quantity("mean_turn", "deg", "mean turn to the left", "turn", "z.1f"),
)
CYCLES: Schema = (
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f"),
    Quantity("sideways", "over_u_max", "to the left", form="z.3f"),
    Quantity("turn", "deg", "turn to the left", form="z.1f"),
)
CONTACT: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("begin", "s", "from"),
    Quantity("end", "s", "to"),
    Quantity("swing", "deg", "swing", form=3),
    Quantity("moved", "mm", "anchor moved", form=3),
)
CHANGE: Schema = (
    Quantity("time", "s", "from"),
    Quantity("leg", head="leg"),
    Quantity("before", head="was", form=lambda gait: gait or "none"),
    Quantity("after", head="is", form=lambda gait: gait or "none"),
)
TOUCHED: Schema = (
    Quantity("obstacle", head="obstacle", read=lambda touch: touch[0]),
    Quantity("time", "s", "first touched", read=lambda touch: touch[1], none="never"),
)
RESOLUTION: Schema = (
    Quantity("time_step", "ms", "time step"),
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f"),
    Quantity("turn", "deg", "turn", form="z.1f"),
    Quantity("forces_off", "percent", read="off", form=".2f"),
    Quantity("jumps", "percent", "jumps", form=".1f"),
)


def robot_record(
    robot: Robot, prediction: Prediction, *, design: str | None = None
) -> dict[str, Any]:
    """A robot's numbers and what statics says of its gait, as docs/commands.md describes it."""
    legs = zip(prediction.legs, _depths(robot), strict=True)
    return {
        **head("robot/1", design or robot),
        **record(ROBOT, robot),
        "prediction": {
            **record(PREDICTION, prediction),
            "drive_needs": record(NEEDS, prediction.drive_needs),
            "legs": [record(PREDICTED, leg, feet=feet) for leg, feet in legs],
            "assumptions": list(prediction.assumptions),
        },
    }


def walk_record(walk: Walk, *, design: str | None = None) -> dict[str, Any]:
    """What a robot did while it walked, as docs/commands.md describes it."""
    from stepwell.simulation import Trial, compare_gaits

    robot, compared = walk.robot, compare_gaits(walk)
    predicted = compared.predicted or (None,) * len(robot.legs)
    legs = zip(walk.gaits.items(), predicted, walk.slip, _depths(robot), strict=True)
    return {
        **head("walk/1", design or robot, None, "mujoco"),
        **record(WALKED, walk),
        "work_per_cycle_mJ": plain(walk.work / walk.cycles, 1e3) if walk.cycles else None,
        "u_max_mm": plain(_most(robot), 1e3),
        **record(MEAN, Trial.of(walk)),
        **record(CYCLES, walk),
        "foot_mm": plain(robot.foot.below, 1e3),
        "as_predicted": compared.same,
        "comparison": compared.text,
        "legs": [
            {
                "name": name,
                "gaits": list(gaits),
                "predicted_gait": expected,
                "slip_mm": plain(slip, 1e3),
                "feet_mm": plain(feet, 1e3),
            }
            for (name, gaits), expected, slip, feet in legs
        ],
        "parameters": _parameters(robot),
    }


def maze_record(
    maze: Maze,
    *,
    design: str | None = None,
    start_seed: int | None = None,
    layout_seed: int | None = None,
) -> dict[str, Any]:
    """What a robot did in an arena, as docs/commands.md describes it.

    Args:
        start_seed, layout_seed: from which start and obstacles were drawn, if they were.
    """
    walk, arena, robot = maze.walk, maze.arena, maze.walk.robot
    return {
        **head("maze/1", design or robot, None, "mujoco"),
        "arena_sha256": _arena_hash(arena),
        "start_seed": start_seed,
        "layout_seed": layout_seed,
        **record(WALKED, walk),
        "arena": arena.title,
        "start_mm": plain(arena.start, 1e3),
        "heading_deg": math.degrees(arena.heading),
        "end_mm": plain((walk.x[-1], walk.y[-1]), 1e3) if len(walk.time) else None,
        "outcome": plain(maze.outcome),
        "limit_s": maze.limit,
        "antennas": [
            {"name": one.name, "leg": one.leg, "connected": one.connected} for one in robot.antennas
        ],
        "touched": [record(TOUCHED, touch) for touch in maze.touched.items()],
        "contacts": [record(CONTACT, contact) for contact in maze.contacts],
        "changes": [record(CHANGE, change) for change in maze.changes],
        "parameters": _parameters(robot),
    }


def sweep_record(
    sweep: Sweep, *, design: str | None = None, seed: int | None = None
) -> dict[str, Any]:
    """What many robots did, as docs/commands.md describes it.

    Args:
        design: text of the design file that was varied, for the hash of it; unknown by default.
        seed: from which the values were drawn, if they were.
    """
    from stepwell.simulation import TRIAL

    values = zip(*sweep.values.values(), strict=True) if sweep.values else ((),) * len(sweep.trials)
    return {
        **head("sweep/1", design, seed, "mujoco"),
        "keys": list(sweep.values),
        "trials": [
            {"values": [float(value) for value in row], **record(TRIAL, trial)}
            for row, trial in zip(values, sweep.trials, strict=True)
        ],
    }


def convergence_record(found: Convergence, *, design: str | None = None) -> dict[str, Any]:
    """How far a walk depends on the time step, as docs/commands.md describes it."""
    return {
        **head("convergence/1", design or found.robot, None, "mujoco"),
        "title": found.robot.title,
        "time_steps": [record(RESOLUTION, row) for row in found.rows],
    }


def _arena_hash(arena: Arena) -> str | None:
    try:
        return digest(dumps(arena))
    except ValueError:
        return None


def _parameters(robot: Robot) -> list[dict[str, Any]]:
    return [
        {"key": one.path, "values": list(one.values), "unit": one.unit, "source": one.source}
        for one in provenance(robot)
    ]


def _depths(robot: Robot) -> list[Any]:
    """For each leg the depths of the feet [m] between which statics says its gait stays."""
    try:
        return list(depths(robot))
    except StaticsError:
        return [None] * len(robot.legs)


def _most(robot: Robot) -> float:
    """u_max [m], the largest step that the legs can make."""
    return max(leg.stroke for leg in robot.legs)
