"""The claim about where a forward step loses what it falls short of the largest step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepwell.paper.claims import Finding, claim, judged
from stepwell.paper.robots.robot import walk_of
from stepwell.robot import TOLERANCE

SHUT = 0.02  # a cell that has opened by less than this share of its travel is shut
NEAR = 0.005  # of the end of the stroke: near 11 [m], as in the claim about the snaps


class Loss(NamedTuple):
    """What one forward step of the left leg loses, in shares of the largest step.

    Attributes:
        whole: the step less what the body advances in the cycle.
        start: lost until the last cell, which opens as the actuator sets out, is shut again.
        snap: lost in the last 5 mm of the way out, in which the snap near 11 is.
        opened: how far the last cell opens at the start, over its travel.
        carried: least force on the foot while it is open [N].
        stood: force on the foot while that cell is shut and the leg steps, median [N].
        airborne: largest force on the foot in those last 5 mm [N].
    """

    whole: float
    start: float
    snap: float
    opened: float
    carried: float
    stood: float
    airborne: float


def forward_loss() -> Loss:
    """Where the last cycle of the forward robot loses."""
    walk = walk_of("forward")
    drive, leg = walk.robot.drive, walk.robot.legs[0]
    begin = walk.starts[-2]
    out = (walk.time >= begin - 1e-9) & (walk.time <= begin + drive.period / 2 + 1e-9)
    step = walk.travel[out, 0, 0] / leg.stroke
    lift = walk.travel[out, 0, 1] / leg.chain.cells[-1].full_travel
    body = (walk.x[out] - walk.x[out][0]) / leg.stroke
    force = walk.foot_force[out, 0]
    # Of the foot's motion under the body, what the body does not make is lost.
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
    return judged(
        loss.snap > loss.whole / 2,
        f"{loss.start:.2f} u_max at the start, {loss.snap:.3f} in the snap near 11",
        otherwise=f"A cycle falls {loss.whole:.2f} u_max short. In the last {NEAR * 1e3:g} mm "
        f"before 11 the foot is in the air and carries {loss.airborne:.2f} N, so no snap there "
        f"can cost a step. It slips at the start instead: "
        f"the weight opens the outer cell by {loss.opened:.0%} of its travel, until the T-foot "
        f"carries it, and the foot, whose load falls to {loss.carried:.2f} N from the "
        f"{loss.stood:.2f} N at which it grips, slides back until the outer cell shuts again. What "
        f"is lost there beyond the whole is won back as the foot lifts. A gait's states do not "
        f"show this, for a cell counts as shut up to {TOLERANCE:.0%} of its travel.",
    )


CLAIMS = (robot_forward_loss,)
