"""Claims about what an antenna has to do to a leg's anchor, by statics of the pair alone."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from stepwell.design import Reprogramming, reprogram
from stepwell.mechanism import Chain
from stepwell.paper.claims import Claim, Finding, Judgement, judged
from stepwell.paper.robots.robot import robot
from stepwell.sequences import Pathway

PRESSED = -0.011  # where a contact is said to push p_in [m] ...
ABOUT = 0.0005  # ... and how near to it that is [m]
INWARDS = (-1.0, 0.0)
BACKWARD = Pathway.COUNTERCLOCKWISE.value

# Stiffness of the inner cell's bands over that of one band. The paper gives no number of bands, and
# its tests used one and two. The factor is in a notebook of the authors, on the inner force; that
# notebook also has a pressed anchor at -13 mm, so it need not be of the robot as built.
BANDS = {"one band": 1.0, "one band times 5/4": 1.25, "two bands": 2.0}
NOT_SAID = (
    "The paper does not say how many bands the inner cell has, and its tests used one and two; a "
    "notebook of the authors, which also has a pressed anchor at -13 mm, puts 5/4 on the inner "
    "force."
)


def pair(q_out: float, bands: float = 2.0, *, pressed: bool = False) -> Chain:
    """Inner and outer cell of a leg of the robot with antennas, feet and weight left out.

    Args:
        q_out: x of the outer cell's outer anchor [m].
        bands: stiffness of the inner cell's bands over the outer one's.
        pressed: p_in where the paper has it under a contact.
    """
    inner, outer = robot("antennas").legs[0].chain.levers
    stiffness = bands * outer.bands[0].stiffness
    inner = replace(inner, band=replace(inner.bands[0], stiffness=stiffness))
    if pressed:
        inner = inner.with_anchors(p=(PRESSED, 0.0))
    return Chain((inner, outer.with_anchors(q=(q_out, 0.0))))


def turning(q_out: float, bands: float = 2.0) -> Reprogramming:
    """How far p_in has to be pushed inwards for the pair to run counterclockwise."""
    return reprogram(pair(q_out, bands), BACKWARD, "inner.p", along=INWARDS, one_way=True)


def largest_outer(bands: float = 2.0) -> float:
    """Largest q_out [m] at which p_in = -11 mm turns the pair round, from 20 mm inwards."""
    chain = pair(0.020, bands, pressed=True)
    return reprogram(chain, BACKWARD, "outer.q", along=INWARDS, one_way=True).anchor_at[0]


def decided(holds: list[bool], ours: str, reason: str) -> Finding:
    """Agreement or difference where every number of bands gives the same, else undetermined."""
    if any(holds) and not all(holds):
        return Finding(ours, Judgement.UNDETERMINED, reason)
    return judged(all(holds), ours, otherwise=reason)


def _turned_round(q_out: float) -> Finding:
    needed = {label: turning(q_out, bands) for label, bands in BANDS.items()}
    places = {label: found.anchor_at[0] for label, found in needed.items()}
    push = needed["two bands"].resistance
    return decided(
        [place >= PRESSED - ABOUT for place in places.values()],
        "turned round from "
        + ", ".join(f"{place * 1e3:.1f} mm ({label})" for label, place in places.items())
        + " on",
        f"By the order of the end forces ({needed['two bands'].method}). {NOT_SAID} With p_in at "
        f"{PRESSED * 1e3:g} mm the pair is turned round for q_out up to "
        f"{largest_outer(1.25) * 1e3:.2f} mm with 5/4 and {largest_outer() * 1e3:.2f} mm with two "
        f"bands. On the way two bands pull at the anchor with up to {push.largest:.2f} N, and the "
        f"antenna spends {push.work_0 * 1e3:.2f} mJ. Statics of the pair alone; on the floor "
        f"`antennas-paper-numbers` finds a little less.",
    )


def _claim(q_mm: int, source: str) -> Claim:
    return Claim(
        f"antennas-bench-{q_mm}",
        f"With q_out = ({q_mm}, 0) mm, p_in at (-11, 0) mm makes the pair run counterclockwise.",
        source,
        f"{BACKWARD} at about -11 mm",
        f"{ABOUT * 1e3:g} mm",
        partial(_turned_round, q_mm * 1e-3),
    )


CLAIMS = (
    _claim(20, "Fig. 4, statics of the pair alone"),
    _claim(14, "Fig. 4, statics of the pair alone (q_out: ours)"),
)
