"""A simulated walk against the gait that statics predicts: the same, or why not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from stepwell.base import ByValue
from stepwell.robot import Prediction, predicted_gaits, too_soft
from stepwell.simulation.runs.walk import LOADED, Walk
from stepwell.statics import StaticsError


@dataclass(frozen=True, slots=True, eq=False)
class GaitComparison(ByValue):
    """The gait of every leg in the last cycle of a walk, against the predicted one.

    Attributes:
        predicted: for each leg the predicted gait; empty where statics gives none.
        same: whether all legs have their predicted gaits; None without a whole cycle, or where
            statics gives none.
        text: one line: that they are the same, or which differ and why, as far as it is known.
    """

    predicted: tuple[str, ...]
    same: bool | None
    text: str


def compare_gaits(walk: Walk) -> GaitComparison:
    """Compare the last cycle of a walk with the gait that statics predicts.

    A cycle counts as the same wherever in it the command begins. Every reason that is given was
    computed; where there is none, the text has the margin of the prediction.

    Args:
        walk: on a bare floor; antennas that obstacles press are not in the prediction.
    """
    robot = walk.robot
    try:
        predicted = predicted_gaits(robot)
    except StaticsError as error:
        return GaitComparison((), None, f"statics predicts no gait: {error}")
    if not walk.cycles:
        return GaitComparison(predicted, None, "no whole cycle to compare with the prediction")
    walked = tuple(walk.gait(leg.name, walk.cycles - 1) for leg in robot.legs)
    off = [
        i for i, gaits in enumerate(zip(walked, predicted, strict=True)) if not _same_cycle(*gaits)
    ]
    why = too_soft(robot)
    if not off:
        return GaitComparison(predicted, True, f"as predicted{f': {why}' if why else ''}")
    differ = ", ".join(
        f"{robot.legs[i].name} goes {walked[i] or 'through no state'} and not {predicted[i]}"
        for i in off
    )
    prediction = robot.predict()
    reasons = [why] if why else []
    reasons += [reason for i in off for reason in _reasons(walk, prediction, i, walked[i])]
    found = "; ".join(dict.fromkeys(reasons)) or _unknown(prediction)
    return GaitComparison(predicted, False, f"not as predicted: {differ}: {found}")


def _same_cycle(one: str, other: str) -> bool:
    """Whether two gaits are one round of states, wherever it begins."""
    a, b = (gait.split(">") for gait in (one, other))
    a, b = (
        [*states[:-1]] if len(states) > 1 and states[0] == states[-1] else states
        for states in (a, b)
    )
    return len(a) == len(b) and any(a[k:] + a[:k] == b for k in range(len(a)))


def _reasons(walk: Walk, prediction: Prediction, index: int, walked: str) -> Iterator[str]:
    """Why a leg walked otherwise than predicted, each computed."""
    robot, leg = walk.robot, prediction.legs[index]
    last = walk.time >= walk.starts[-2]
    if walk.cycles == 1 and leg.first_gait != leg.gait:
        yield "it walked one cycle, and the predicted one comes after it"
    if walk.antenna.size and float(walk.antenna.max()) > 0.0 and walk.touch.max() > 0.0:
        yield "antennas were pressed, and the prediction is of none pressed"
    if float(walk.foot_force[last, index].max()) < LOADED:
        yield f"the foot of {leg.name} carries nothing in the last cycle"
    least, most = walk.stroke[last].min(), walk.stroke[last].max()
    low, high = prediction.strokes
    near = 0.2 * min(robot.legs[index].chain.full_travels)
    if abs(least - low) > near or abs(most - high) > near:
        yield (
            f"the carriage went from {least * 1e3:.1f} to {most * 1e3:.1f} mm where statics takes "
            f"it from {low * 1e3:.1f} to {high * 1e3:.1f} mm"
        )
    others = {*leg.alternatives, *([leg.nearest] if leg.margin < leg.uncertainty else [])}
    if any(_same_cycle(walked, other) for other in others):
        yield f"statics cannot tell the two apart for {leg.name}"
    shallow, deep = prediction.depths[index]
    if not shallow < robot.foot.below < deep:
        yield (
            f"feet stand {robot.foot.below * 1e3:.2f} mm deep, and statics is sure of {leg.name} "
            f"from {shallow * 1e3:.2f} to {deep * 1e3:.2f} mm only"
        )


def _unknown(prediction: Prediction) -> str:
    """What is said where no reason was found: how sure the prediction is."""
    least = min(prediction.legs, key=lambda leg: leg.margin - leg.uncertainty)
    return (
        f"no reason found; of the {least.margin * 1e3:.3g} mN that change the predicted gait of "
        f"{least.name}, statics does not know {least.uncertainty * 1e3:.3g} mN"
    )
