"""Reasons why a hopper cannot do its task, found by statics before anything is simulated."""

import math
from collections.abc import Iterator

import numpy as np

from stepwell.base import InputError, to_unit
from stepwell.mechanism import Chain
from stepwell.robot.hopper import Hopper, Task
from stepwell.robot.jump import Release, predicted_stop, release

_LOOKS = 513
# Stiffness is raised up to this factor in the search for one that lifts the hopper.
_MOST = 4096.0


def snap_of(hopper: Hopper) -> Release:
    """The snap of a hopper that does its task.

    Raises:
        ValueError: the task is impossible, with every reason in a line.
        StaticsError: the path of the chain could not be computed.
    """
    snap = release(hopper.whole, hopper.foot_after, hopper.load)
    reasons = [*_stretched(hopper), *_too_weak(hopper, snap)]
    if snap is not None:
        out = sum(snap.after[: hopper.foot_after])
        reasons += [*_actuator(hopper, snap), *foot_reasons(hopper, out), *_losses(hopper, snap)]
    if reasons or snap is None:
        raise InputError("\n".join(reasons))
    return snap


def longest_stretch(chain: Chain) -> float:
    """Largest stretch of any band of a chain of lever cells [1]."""
    return max(cell.largest_stretch for cell in chain.levers)


def _stretched(hopper: Hopper) -> Iterator[str]:
    most = hopper.springs.stretch
    for name, cell in zip(hopper.chain.names, hopper.chain.levers, strict=True):
        for band in cell.bands:
            ratio = band.largest_stretch(cell.lever, cell.limit)
            if ratio > most:
                # Rounded up, so that the advice suffices.
                _, longest = band.lengths(cell.lever, cell.limit)
                rest = math.ceil(10.0 * to_unit(longest / most, "mm")) / 10.0
                yield (
                    f"cell {name!r}: its band is stretched to {ratio:.3g} times its rest length: "
                    f"must be <= {most:.3g} (springs.stretch); use a rest length of {rest:g} mm "
                    f"or more, or move its anchors."
                )


def _too_weak(hopper: Hopper, snap: Release | None) -> Iterator[str]:
    if snap is not None:
        return
    pushes = max(
        float(cell.force_at(cell.travel(np.linspace(-cell.limit, cell.limit, _LOOKS))).max())
        for cell in hopper.whole.levers[hopper.foot_after :]
    )
    if release(hopper.whole, hopper.foot_after, 0.0) is None:
        yield (
            f"chain: no snap of a loading stroke moves the foot away from the body, and the cells "
            f"behind the foot push with {pushes:.3g} N at most against a weight of "
            f"{hopper.load:.3g} N: put a bistable cell before the foot, and behind it a cell that "
            f"moves first and pulls harder than the bistable one after its snap begins."
        )
        return
    factor = _factor(hopper)
    stronger = (
        f"bands of {factor:.3g} times the stiffness snap with this load"
        if factor < _MOST
        else "no stiffer bands of this chain snap with this load"
    )
    what = {Task.JUMP: "body", Task.THROW: "ball and block", Task.STRIKE: "block"}[hopper.task]
    yield (
        f"too weak: the cells behind the foot push with {pushes:.3g} N at most, and the weight of "
        f"the {what} along the chain is {hopper.load:.3g} N ({to_unit(hopper.moved, 'g'):.4g} g), "
        f"so no snap lifts it; {stronger}."
    )


def _factor(hopper: Hopper) -> float:
    """Least factor of all stiffnesses with which a snap lifts the load, to 1 %."""
    low, high = 1.0, 2.0
    while high < _MOST and release(hopper.whole, hopper.foot_after, hopper.load / high) is None:
        low, high = high, 2.0 * high
    if high >= _MOST:
        return math.inf
    while high > 1.01 * low:
        middle = math.sqrt(low * high)
        if release(hopper.whole, hopper.foot_after, hopper.load / middle) is None:
            low = middle
        else:
            high = middle
    return high


def _actuator(hopper: Hopper, snap: Release) -> Iterator[str]:
    most = hopper.actuator.force
    if snap.peak_force > most:
        way = "pulls" if snap.largest_force == snap.peak_force else "pushes"
        # Load and friction do not fall with the bands; rounded down, so that the advice suffices.
        kept = snap.load + sum(cell.friction for cell in hopper.whole.levers)
        softer = max(most - kept, 0.0) / (snap.peak_force - kept)
        softer = round(softer - 5e-4, 3)
        yield (
            f"actuator.force = {most:.3g} N: must be >= {snap.peak_force:.3g} N, with which the "
            f"actuator {way} in a cycle; use a stronger actuator, or bands of at most "
            f"{softer:g} times the stiffness."
        )


def landing_length(hopper: Hopper, snap: Release) -> float:
    """Least length of the foot [m] on which a tilted hopper lands and stands after a snap.

    The line of the landing velocity through the centre of mass meets the floor ahead of the foot's
    middle by twice the height times tan τ, and friction passes on at most µ. Within half the foot
    the floor's force can stop the body without turning it.
    """
    return _least_foot(hopper, sum(snap.after[: hopper.foot_after]))


def _least_foot(hopper: Hopper, out: float) -> float:
    """`landing_length` for a foot that is `out` [m] from its place at the body."""
    high = (hopper.height + out) * math.cos(hopper.tilt) * hopper.body_mass / hopper.mass
    slope = math.tan(hopper.tilt)
    return 2.0 * high * (slope + min(slope, hopper.friction))


def _losses(hopper: Hopper, snap: Release) -> Iterator[str]:
    if len(hopper.chain) == 2 and predicted_stop(hopper, snap) == 0.0:
        yield (
            f"damping = {hopper.damping:.3g} N s/m, springs.loss = "
            f"{to_unit(hopper.springs.loss, '%'):.3g} %: friction, dampers and springs take all "
            f"energy of the snap; reduce them."
        )


def foot_reasons(hopper: Hopper, out: float) -> Iterator[str]:
    """Reasons why a foot that lands `out` [m] from its place at the body slips or turns over."""
    if hopper.task is not Task.JUMP:
        return
    slope, least = math.tan(hopper.tilt), _least_foot(hopper, out)
    if slope > hopper.friction:
        yield (
            f"tilt = {math.degrees(hopper.tilt):.3g} deg: must be <= "
            f"{math.degrees(math.atan(hopper.friction)):.3g} deg, at which the foot slips with a "
            f"friction of {hopper.friction:.3g}."
        )
    if hopper.foot_length < least:
        yield (
            f"foot_length = {to_unit(hopper.foot_length, 'mm'):.4g} mm: must be >= "
            f"{to_unit(least, 'mm'):.4g} mm, or the hopper turns over when it lands at this tilt; "
            f"use a longer foot, less tilt or a lower body."
        )
