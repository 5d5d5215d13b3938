"""Claims about the walking robot, each found by simulating it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from stepwell import files
from stepwell.paper.claims import Finding, claim, judged
from stepwell.robot import Robot
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    from stepwell.simulation import Walk

CYCLES = 8
FORWARD = (0.71, 0.08)
BACKWARD = (0.96, 0.04)
TURN_DEG = (15.0, 2.5)
STANDS_STILL = 0.15

ASSUMED = (
    "One set of assumed numbers serves all claims about the robot: masses, centre of mass, "
    "supports, track, friction and depth of the feet, damping, period and stiffness of the drive "
    "(`stepwell robot show preset:robot-forward`). It was searched for until the paper's results "
    "came out, so they test the set together and none of its numbers alone."
)


def robot(name: str) -> Robot:
    """A robot that comes with the package."""
    return files.load_robot(f"preset:robot-{name}")


@cache
def walk_of(name: str) -> Walk:
    """Eight cycles of a robot that comes with the package."""
    from stepwell.simulation import walk

    return walk(robot(name), CYCLES)


def _late(values: np.ndarray) -> float:
    """The mean over a walk, the first cycle left out: it starts from rest."""
    return float(np.mean(values[1:]))


def _straight(name: str, sign: int, target: tuple[float, float]) -> Finding:
    walk = walk_of(name)
    advance = sign * _late(walk.advance)
    return judged(
        abs(advance - target[0]) <= target[1],
        f"{advance:.2f}",
        note=f"Gait of both legs: {walk.gaits['left'][-1]}. {ASSUMED}",
        otherwise=f"Gaits: {walk.gaits['left'][-1]} and {walk.gaits['right'][-1]}. {ASSUMED}",
    )


@claim("Fig. 3", "d/u_max = 0.71", f"± {FORWARD[1]}")
def robot_forward() -> Finding:
    """With q_out = (20, 0) mm on both sides the robot walks forward."""
    return _straight("forward", 1, FORWARD)


@claim("Fig. 3", "d/u_max = 0.96", f"± {BACKWARD[1]}")
def robot_backward() -> Finding:
    """With q_out = (5, 0) mm on both sides it walks backward."""
    return _straight("backward", -1, BACKWARD)


@claim(
    "Fig. 3", "π/12 = 15° a cycle, d negligible", f"± {TURN_DEG[1]}°, |d|/u_max < {STANDS_STILL}"
)
def robot_turn() -> Finding:
    """With one leg of each kind it turns on the spot, to either side."""
    turns, moves = [], []
    for name, sign in (("left", 1), ("right", -1)):
        walk = walk_of(name)
        turns.append(sign * float(np.degrees(_late(walk.turn))))
        moves.append(float(np.hypot(_late(walk.advance), _late(walk.sideways))))
    agrees = max(abs(turn - TURN_DEG[0]) for turn in turns) <= TURN_DEG[1]
    return judged(
        agrees and max(moves) < STANDS_STILL,
        f"{turns[0]:.1f}° to the left, {turns[1]:.1f}° to the right; |d|/u_max {max(moves):.2f}",
        note=ASSUMED,
        otherwise=f"Outside the tolerance. {ASSUMED}",
    )


@claim("Fig. 3 (our reading)", "00>10>11>01>00", "the same states")
def robot_15_in_the_air() -> Finding:
    """With q_out = (15, 0) mm the legs go clockwise on the bench."""
    from stepwell.simulation import walk

    design = robot("15")
    hung = walk(replace(design, floor=replace(design.floor, gravity=0.0)), 3)
    pathways = {leg.chain.cycle().pathway for leg in design.legs}
    gaits = {gaits[-1] for gaits in hung.gaits.values()}
    return judged(
        pathways == {Pathway.CLOCKWISE} and gaits == {"00>10>11>01>00"},
        " and ".join(sorted(gaits)),
        note="Statics and simulation without gravity agree.",
        otherwise=f"Statics says {', '.join(str(p) for p in pathways)}.",
    )


@claim("Fig. 3 (our reading)", "no forward walking", f"d/u_max < {STANDS_STILL}")
def robot_15_on_the_floor() -> Finding:
    """With q_out = (15, 0) mm the robot does not walk forward."""
    walk = walk_of("15")
    advance = _late(walk.advance)
    return judged(
        advance < STANDS_STILL,
        f"d/u_max {advance:z.2f}, {walk.gaits['left'][-1]}",
        note="The weight on the feet opens the outer cells, until the T-foot carries it; at "
        "q_out = 15 mm that is enough for the outer cell to move first. " + ASSUMED,
        otherwise=f"It walks. {ASSUMED}",
    )


@claim("Fig. 3", "01 and 10", "the same states")
def robot_states() -> Finding:
    """After 7¾ cycles a forward leg is in 01 and a backward leg in 10."""
    states = {name: walk_of(name).state("left", 7.75 * 2.0) for name in ("forward", "backward")}
    return judged(
        states == {"forward": "01", "backward": "10"},
        f"{states['forward']} and {states['backward']}",
        otherwise=f"Another state. {ASSUMED}",
    )


CLAIMS = (
    robot_forward,
    robot_backward,
    robot_turn,
    robot_15_in_the_air,
    robot_15_on_the_floor,
    robot_states,
)
