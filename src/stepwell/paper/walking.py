"""Claims about the walking robot, from simulation, and the losses of its step."""

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell import base, files, sequences
from stepwell.paper.claims import Finding, claim, finding_of
from stepwell.robot import TOLERANCE, Robot

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
    """A shipped robot."""
    return files.load(f"preset:robot-{name}").robot


@cache
def walk_of(name: str) -> "Walk":
    """A walk of eight cycles of a shipped robot."""
    from stepwell.simulation import walk

    return walk(robot(name), CYCLES)


def _late(values: np.ndarray) -> float:
    """The mean over a walk without its first cycle, which starts from rest."""
    return float(np.mean(values[1:]))


def _straight(name: str, sign: int, target: tuple[float, float]) -> Finding:
    walk = walk_of(name)
    advance = sign * _late(walk.advance)
    return finding_of(
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
    walks = walk_of("left"), walk_of("right")
    left, right = (float(np.degrees(_late(walk.turn))) for walk in walks)
    moved = max(float(np.hypot(_late(walk.advance), _late(walk.sideways))) for walk in walks)
    off = max(abs(turn - TURN_DEG[0]) for turn in (left, -right))
    return finding_of(
        off <= TURN_DEG[1] and moved < STANDS_STILL,
        f"{left:.1f}° to the left, {-right:.1f}° to the right; |d|/u_max {moved:.2f}",
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
    return finding_of(
        pathways == {sequences.Pathway.CLOCKWISE} and gaits == {"00>10>11>01>00"},
        " and ".join(sorted(gaits)),
        note="Statics and simulation without gravity agree.",
        otherwise=f"Statics says {', '.join(str(p) for p in pathways)}.",
    )


@claim("Fig. 3 (our reading)", "no forward walking", f"d/u_max < {STANDS_STILL}")
def robot_15_on_the_floor() -> Finding:
    """With q_out = (15, 0) mm the robot does not walk forward."""
    walk = walk_of("15")
    advance = _late(walk.advance)
    return finding_of(
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
    return finding_of(
        states == {"forward": "01", "backward": "10"},
        f"{states['forward']} and {states['backward']}",
        otherwise=f"Another state. {ASSUMED}",
    )


WALKING_CLAIMS = (
    robot_forward,
    robot_backward,
    robot_turn,
    robot_15_in_the_air,
    robot_15_on_the_floor,
    robot_states,
)


SHUT = 0.02  # a cell open by less than this fraction of its travel counts as shut
NEAR = 0.005  # distance to the end of the stroke near 11 [m], as in the claim about the snaps


class Loss(NamedTuple):
    """Losses of one forward step of the left leg, as fractions of the largest step."""

    whole: float  # the step less the advance of the body in the cycle
    start: float  # lost until the last cell, which opens as the actuator sets out, is shut again
    snap: float  # lost in the last 5 mm of loading, which contain the snap near 11
    opened: float  # largest opening of the last cell at the start, over its travel
    carried: float  # least force on the foot while it is open [N]
    stood: float  # force on the foot while that cell is shut and the leg steps, median [N]
    airborne: float  # largest force on the foot in those last 5 mm [N]


def forward_loss() -> Loss:
    """Losses in the last cycle of the forward robot."""
    walk = walk_of("forward")
    drive, leg = walk.robot.drive, walk.robot.legs[0]
    begin = walk.starts[-2]
    out = (walk.time >= begin - 1e-9) & (walk.time <= begin + drive.period / 2 + 1e-9)
    step = walk.travel[out, 0, 0] / leg.stroke
    lift = walk.travel[out, 0, 1] / leg.chain.cells[-1].full_travel
    body = (walk.x[out] - walk.x[out][0]) / leg.stroke
    force = walk.foot_force[out, 0]
    # Motion of the foot under the body that does not move the body is lost.
    lost = step - body
    setting_out = step < 0.5
    widest = int(np.argmax(np.where(setting_out, lift, 0.0)))
    shut = widest + int(np.argmax(lift[widest:] < SHUT))
    near = walk.stroke[out] > drive.amplitude - NEAR
    return Loss(
        whole=1.0 - float(walk.advance[-1]),
        start=float(lost[shut]),
        snap=float(np.ptp(body[near])),
        opened=float(lift[widest]),
        carried=float(force[widest : shut + 1].min()),
        stood=float(np.median(force[(lift < SHUT) & (step > step[shut]) & (step < 1 - SHUT)])),
        airborne=float(force[near].max()),
    )


@claim("Fig. 3", "the snap near 11", "more than half of what is lost")
def robot_forward_loss() -> Finding:
    """A forward step is shorter than the largest one because of the snap near 11."""
    loss = forward_loss()
    return finding_of(
        loss.snap > loss.whole / 2,
        f"{loss.start:.2f} u_max at the start, {loss.snap:.3f} in the snap near 11",
        otherwise=f"A cycle falls {loss.whole:.2f} u_max short. In the last "
        f"{base.to_unit(NEAR, 'mm'):g} mm before 11 the foot is in the air and carries "
        f"{loss.airborne:.2f} N, so no snap there can cost a step. It slips at the start instead: "
        f"the weight opens the outer cell by {loss.opened:.0%} of its travel, until the T-foot "
        f"carries it, and the foot, whose load falls to {loss.carried:.2f} N from the "
        f"{loss.stood:.2f} N at which it grips, slides back until the outer cell shuts again. What "
        f"is lost there beyond the whole is won back as the foot lifts. A gait's states do not "
        f"show this, for a cell counts as shut up to {TOLERANCE:.0%} of its travel.",
    )


LOSS_CLAIMS = (robot_forward_loss,)
