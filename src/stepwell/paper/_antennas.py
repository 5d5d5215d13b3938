"""Claims about what an antenna has to do to a leg's anchor, by statics of the pair alone."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

from stepwell.design.reprogramming import Reprogramming, reprogram
from stepwell.mechanism import Cell, Chain
from stepwell.paper._robot import robot
from stepwell.paper.claim import Claim, Finding, judged
from stepwell.sequences import Pathway

PRESSED = -0.011  # where a contact is said to push p_in [m]
INWARDS = (-1.0, 0.0)
BACKWARD = Pathway.COUNTERCLOCKWISE.value


def pair(q_out: float, *, factor: bool = True) -> Chain:
    """Inner and outer cell of a leg of the robot with antennas, feet and weight left out.

    Args:
        q_out: x of the outer cell's outer anchor [m].
        factor: with the authors' 5/4 on the force of the inner band.
    """
    inner, outer = robot("antennas").legs[0].chain.cells
    if not factor:
        inner = replace(inner, band=replace(inner.bands[0], stiffness=outer.bands[0].stiffness))
    return Chain((inner, outer.with_anchors(q=(q_out, 0.0))))


def turning(q_out: float, *, factor: bool = True) -> Reprogramming:
    """How far p_in has to be pushed inwards for the pair to run counterclockwise."""
    chain = pair(q_out, factor=factor)
    return reprogram(chain, BACKWARD, "inner.p", along=INWARDS, one_way=True)


def pressed(q_out: float, *, factor: bool = True) -> Chain:
    """The pair with p_in where the paper has it under a contact."""
    chain = pair(q_out, factor=factor)
    inner: Cell = chain.cells[0]
    return replace(chain, cells=(inner.with_anchors(p=(PRESSED, 0.0)), chain.cells[1]))


def largest_outer() -> float:
    """Largest q_out [m] at which p_in = -11 mm turns the pair round, from 20 mm inwards."""
    found = reprogram(pressed(0.020), BACKWARD, "outer.q", along=INWARDS, one_way=True)
    return found.place[0]


def _turned_round(q_out: float) -> Finding:
    done = str(pressed(q_out).cycle().sequence)
    needed, plain = turning(q_out), turning(q_out, factor=False)
    rest = pair(q_out).cells[0].bands[0].p[0]
    anywhere = reprogram(pair(q_out), BACKWARD, "inner.p", reach=abs(PRESSED - rest))
    where = (
        "nor does a displacement of that size in any direction of the plane"
        if math.isinf(anywhere.distance)
        else "another direction of the plane does it"
    )
    push = needed.push
    return judged(
        done == BACKWARD,
        f"at {PRESSED * 1e3:g} mm {done}; turned round from {needed.place[0] * 1e3:.1f} mm on",
        note=f"By the order of the end forces ({needed.method}).",
        otherwise=f"{PRESSED * 1e3:g} mm does not turn the pair round, {where}. By the end forces "
        f"({needed.method}) it takes p_in = {needed.place[0] * 1e3:.2f} mm with the authors' "
        f"factor 5/4 on the inner force, and {plain.place[0] * 1e3:.2f} mm without it. On the way "
        f"the band pulls at the anchor with up to {push.largest:.2f} N, and the antenna spends "
        f"{push.work_0 * 1e3:.2f} mJ. With p_in at {PRESSED * 1e3:g} mm the pair is turned round "
        f"for q_out up to {largest_outer() * 1e3:.2f} mm. Statics of the pair alone; with feet on "
        f"the floor `antennas-paper-numbers` finds about the same q_out.",
    )


def _claim(q_mm: int, source: str) -> Claim:
    return Claim(
        f"antennas-bench-{q_mm}",
        f"With q_out = ({q_mm}, 0) mm, p_in at (-11, 0) mm makes the pair run counterclockwise.",
        source,
        f"{BACKWARD} at -11 mm",
        "the same states",
        partial(_turned_round, q_mm * 1e-3),
    )


CLAIMS = (
    _claim(20, "Fig. 4, statics of the pair alone"),
    _claim(14, "Fig. 4, statics of the pair alone (q_out: ours)"),
)
