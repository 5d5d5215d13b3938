"""What robots do as plain numbers with the unit in every name, for other programs to read."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stepwell.files import digest, dumps, provenance
from stepwell.results.head import head
from stepwell.results.run import finite
from stepwell.robot import Arena, Flip, LegPrediction, Prediction, Push, Robot
from stepwell.robot.gait import depths
from stepwell.statics import StaticsError

if TYPE_CHECKING:
    from stepwell.simulation import Convergence, Maze, Sweep, Walk

ROBOT_SCHEMA = "stepwell.robot/1"
WALK_SCHEMA = "stepwell.walk/1"
MAZE_SCHEMA = "stepwell.maze/1"
SWEEP_SCHEMA = "stepwell.sweep/1"
CONVERGENCE_SCHEMA = "stepwell.convergence/1"


def robot_record(
    robot: Robot, prediction: Prediction, *, design: str | None = None
) -> dict[str, Any]:
    """A robot's numbers and what statics says of its gait, as JSON can hold it.

    Args:
        robot: any robot.
        prediction: of it.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes.
    """
    return {
        **head(ROBOT_SCHEMA, design or robot),
        "title": robot.title,
        "mass_g": robot.mass * 1e3,
        "weight_N": robot.weight,
        "u_max_mm": _most(robot) * 1e3,
        "parameters": _parameters(robot),
        "prediction": {
            "motion": prediction.motion.name.lower(),
            "advance_over_u_max": prediction.advance,
            "sideways_over_u_max": prediction.sideways,
            "turn_deg": math.degrees(prediction.turn),
            "near_boundary": prediction.near_boundary,
            "legs": [
                _predicted(leg, feet)
                for leg, feet in zip(prediction.legs, _depths(robot), strict=True)
            ],
            "assumptions": list(prediction.assumptions),
        },
    }


def walk_record(walk: Walk, *, design: str | None = None) -> dict[str, Any]:
    """What a robot did while it walked, as JSON can hold it.

    Args:
        walk: any walk.
        design: text of the robot's design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes.
    """
    from stepwell.simulation import Trial

    mean = Trial.of(walk)
    return {
        **head(WALK_SCHEMA, design or walk.robot, None, "mujoco"),
        **_common(walk),
        "u_max_mm": _most(walk.robot) * 1e3,
        "mean_advance_over_u_max": finite(mean.advance),
        "mean_turn_deg": finite(math.degrees(mean.turn)),
        "advance_over_u_max": walk.advance.tolist(),
        "sideways_over_u_max": walk.sideways.tolist(),
        "turn_deg": [math.degrees(turn) for turn in walk.turn],
        "foot_mm": walk.robot.foot.below * 1e3,
        "legs": [
            {"name": name, "gaits": list(gaits), "slip_mm": float(slip) * 1e3, "feet_mm": feet}
            for (name, gaits), slip, feet in zip(
                walk.gaits.items(), walk.slip, _depths(walk.robot), strict=True
            )
        ],
        "parameters": _parameters(walk.robot),
    }


def maze_record(
    maze: Maze,
    *,
    design: str | None = None,
    start_seed: int | None = None,
    layout_seed: int | None = None,
) -> dict[str, Any]:
    """What a robot did in an arena, as JSON can hold it.

    Args:
        maze: a way through any arena.
        design: text of the robot's design file, for the hash of it; written anew by default.
        start_seed, layout_seed: from which start and obstacles were drawn, if they were.

    Returns:
        The record that docs/commands.md describes.
    """
    walk, arena, robot = maze.walk, maze.arena, maze.walk.robot
    end = [float(walk.x[-1]) * 1e3, float(walk.y[-1]) * 1e3] if len(walk.time) else None
    return {
        **head(MAZE_SCHEMA, design or robot, None, "mujoco"),
        "arena_sha256": _arena_hash(arena),
        "start_seed": start_seed,
        "layout_seed": layout_seed,
        **_common(walk),
        "arena": arena.title,
        "start_mm": [arena.start[0] * 1e3, arena.start[1] * 1e3],
        "heading_deg": math.degrees(arena.heading),
        "end_mm": end,
        "outcome": maze.outcome.name.lower(),
        "limit_s": maze.limit,
        "antennas": [
            {"name": one.name, "leg": one.leg, "connected": one.connected} for one in robot.antennas
        ],
        "touched": [{"obstacle": name, "time_s": time} for name, time in maze.touched.items()],
        "contacts": [
            {
                "antenna": contact.antenna,
                "begin_s": contact.begin,
                "end_s": contact.end,
                "swing_deg": math.degrees(contact.swing),
                "moved_mm": contact.moved * 1e3,
            }
            for contact in maze.contacts
        ],
        "changes": [
            {"time_s": one.time, "leg": one.leg, "before": one.before, "after": one.after}
            for one in maze.changes
        ],
        "parameters": _parameters(robot),
    }


def sweep_record(
    sweep: Sweep, *, design: str | None = None, seed: int | None = None
) -> dict[str, Any]:
    """What many robots did, as JSON can hold it.

    Args:
        sweep: any.
        design: text of the design file that was varied, for the hash of it; unknown by default.
        seed: from which the values were drawn, if they were.

    Returns:
        The record that docs/commands.md describes.
    """
    return {
        **head(SWEEP_SCHEMA, design, seed, "mujoco"),
        "keys": list(sweep.values),
        "trials": [
            {
                "values": [float(values[i]) for values in sweep.values.values()],
                "advance_over_u_max": finite(trial.advance),
                "sideways_over_u_max": finite(trial.sideways),
                "turn_deg": finite(math.degrees(trial.turn)),
                "work_mJ": finite(trial.work, 1e3),
                "gaits": list(trial.gaits),
                "stopped": trial.stopped,
            }
            for i, trial in enumerate(sweep.trials)
        ],
    }


def convergence_record(found: Convergence, *, design: str | None = None) -> dict[str, Any]:
    """How far a walk depends on the time step, as JSON can hold it.

    Args:
        found: any.
        design: text of the robot's design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes.
    """
    return {
        **head(CONVERGENCE_SCHEMA, design or found.robot, None, "mujoco"),
        "title": found.robot.title,
        "time_steps": [
            {
                "time_step_ms": row.time_step * 1e3,
                "advance_over_u_max": row.advance,
                "turn_deg": math.degrees(row.turn),
                "forces_off_percent": row.off * 100,
                "jumps_percent": row.jumps * 100,
            }
            for row in found.rows
        ],
    }


def _common(walk: Walk) -> dict[str, Any]:
    robot, settings = walk.robot, walk.settings
    went = len(walk.time) > 0
    return {
        "title": robot.title,
        "cycles": walk.cycles,
        "period_s": robot.drive.period,
        "duration_s": max(0.0, float(walk.time[-1])) if went else 0.0,
        "distance_mm": walk.distance * 1e3 if went else 0.0,
        "work_mJ": walk.work * 1e3,
        "weight_N": robot.weight,
        "cost_of_transport": finite(walk.cost_of_transport) if went else None,
        "stopped": walk.stopped,
        "simulation": {
            "time_step_ms": settings.time_step * 1e3,
            "contact_time_ms": settings.contact_time * 1e3,
            "integrator": str(settings.integrator),
            "linkage": str(settings.linkage),
        },
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


def _predicted(leg: LegPrediction, feet: list[float] | None) -> dict[str, Any]:
    return {
        "name": leg.name,
        "gait": leg.gait,
        "advance_over_u_max": leg.advance,
        "slip_mm": leg.slip * 1e3,
        "margin_mN": finite(leg.margin, 1e3),
        "uncertainty_mN": finite(leg.uncertainty, 1e3),
        "nearest": leg.nearest,
        "feet_mm": feet,
        "alternatives": list(leg.alternatives),
        "near_boundary": leg.near_boundary,
        "pushes": [_push(push) for push in leg.pushes],
        "flips": [_flip(flip) for flip in leg.flips],
    }


def _push(push: Push) -> dict[str, Any]:
    return {
        "direction": "loading" if push.loading else "unloading",
        "step_mm": push.step * 1e3,
        "gain_mm": push.gain * 1e3,
        "load_N": push.load,
        "drag_N": push.drag,
        "largest_drag_N": finite(push.largest_drag),
        "limit": push.limit.value,
    }


def _flip(flip: Flip) -> dict[str, Any]:
    return {
        "antenna": flip.antenna,
        "displacement_mm": flip.displacement * 1e3,
        "earliest_mm": flip.earliest * 1e3,
        "latest_mm": finite(flip.latest, 1e3),
        "swing_deg": math.degrees(flip.swing),
        "gait": flip.gait,
    }


def _depths(robot: Robot) -> list[list[float] | None]:
    """For each leg the depths of the feet [mm] between which statics says its gait stays."""
    try:
        return [[depth * 1e3 for depth in both] for both in depths(robot)]
    except StaticsError:
        return [None] * len(robot.legs)


def _most(robot: Robot) -> float:
    """u_max [m], the largest step that the legs can make."""
    return max(leg.stroke for leg in robot.legs)
