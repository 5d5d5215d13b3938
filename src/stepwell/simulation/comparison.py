"""Comparison of a walk with the predicted gait, and its convergence with the time step."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, brief, notify, to_unit
from stepwell.robot import Prediction, Robot, known_depths, predicted_gaits, too_soft
from stepwell.simulation.simulator import Settings
from stepwell.simulation.walks import LOADED, Walk, walk
from stepwell.statics import StaticsError


@dataclass(frozen=True, slots=True, eq=False)
class GaitComparison(ByValue):
    """Comparison of the gait of every leg in the last cycle of a walk with the predicted gait.

    Attributes:
        robot: the robot of the walk.
        predicted: for each leg the predicted gait; empty if statics gives none.
        same: whether all legs have their predicted gaits; None without a whole cycle or prediction.
        text: one line: agreement, or the legs that differ and the likely reasons.
    """

    robot: Robot = field(repr=False)
    predicted: tuple[str, ...]
    same: bool | None
    text: str

    @property
    def depths(self) -> tuple[tuple[float, float] | None, ...]:
        """For each leg the range of preload depths [m] in which it certainly keeps its gait.

        None if statics cannot determine it. Computed on first access.
        """
        return known_depths(self.robot)


def compare_gaits(walk: Walk) -> GaitComparison:
    """Compare the last cycle of a walk on a bare floor with the gait that statics predicts.

    A cycle counts as the same wherever in it the command begins. Every reason given was computed;
    where there is none, the text has the margin of the prediction. Pressed antennas are not in it.
    """
    robot = walk.robot
    try:
        predicted = predicted_gaits(robot)
    except StaticsError as error:
        return GaitComparison(robot, (), None, f"statics predicts no gait: {error}")
    if not walk.cycles:
        text = "no whole cycle to compare with the prediction"
        return GaitComparison(robot, predicted, None, text)
    walked = tuple(walk.gait(leg.name, walk.cycles - 1) for leg in robot.legs)
    off = [
        i for i, gaits in enumerate(zip(walked, predicted, strict=True)) if not _same_cycle(*gaits)
    ]
    why = too_soft(robot)
    if not off:
        return GaitComparison(
            robot, predicted, True, f"gaits as predicted{f': {why}' if why else ''}"
        )
    differ = ", ".join(
        f"{robot.legs[i].name} goes {walked[i] or 'through no state'} instead of {predicted[i]}"
        for i in off
    )
    prediction = robot.predict()
    reasons = [why] if why else []
    reasons += [reason for i in off for reason in _reasons(walk, prediction, i, walked[i])]
    explanation = "; ".join(dict.fromkeys(reasons)) or _unknown(prediction)
    return GaitComparison(
        robot, predicted, False, f"gaits not as predicted: {differ}: {explanation}"
    )


def _same_cycle(one: str, other: str) -> bool:
    """Whether two gaits are the same cycle of states, with any first state."""
    a, b = (gait.split(">") for gait in (one, other))
    a, b = (each[:-1] if len(each) > 1 and each[0] == each[-1] else each for each in (a, b))
    return len(a) == len(b) and any(a[k:] + a[:k] == b for k in range(len(a)))


def _reasons(walk: Walk, prediction: Prediction, index: int, walked: str) -> Iterator[str]:
    robot, leg = walk.robot, prediction.legs[index]
    last = walk.time >= walk.starts[-2]
    if walk.cycles == 1 and leg.first_gait != leg.gait:
        yield "it walked one cycle, and the prediction is for later cycles"
    if walk.antenna.size and float(walk.antenna.max()) > 0.0 and walk.touch.max() > 0.0:
        yield "antennas were pressed, and the prediction is without contact"
    if float(walk.foot_force[last, index].max()) < LOADED:
        yield f"the foot of {leg.name} carries nothing in the last cycle"
    least, most = walk.stroke[last].min(), walk.stroke[last].max()
    low, high = prediction.strokes
    near = 0.2 * min(robot.legs[index].chain.full_travels)
    if abs(least - low) > near or abs(most - high) > near:
        yield (
            f"the carriage moved from {to_unit(least, 'mm'):.1f} to {to_unit(most, 'mm'):.1f} mm, "
            f"in statics from {to_unit(low, 'mm'):.1f} to {to_unit(high, 'mm'):.1f} mm"
        )
    others = {*leg.alternatives, *([leg.nearest] if leg.margin < leg.uncertainty else [])}
    if any(_same_cycle(walked, other) for other in others):
        yield f"statics cannot separate the two gaits of {leg.name}"
    shallow, deep = prediction.depths[index]
    if not shallow < robot.foot.below < deep:
        yield (
            f"the preload depth is {to_unit(robot.foot.below, 'mm'):.2f} mm; statics is certain of "
            f"{leg.name} from {to_unit(shallow, 'mm'):.2f} to {to_unit(deep, 'mm'):.2f} mm only"
        )


def _unknown(prediction: Prediction) -> str:
    least = min(prediction.legs, key=lambda leg: leg.margin - leg.uncertainty)
    return (
        f"reason unknown; the predicted gait of {least.name} has a margin of "
        f"{to_unit(least.margin, 'mN'):.3g} mN, the uncertainty of statics is "
        f"{to_unit(least.uncertainty, 'mN'):.3g} mN"
    )


STEPS = (1e-3, 5e-4, 2.5e-4)
JUMP = 0.2  # a ground reaction force that changes by more than this fraction in one step jumps


class Resolution(NamedTuple):
    """A walk at one time step.

    Attributes:
        time_step: [s].
        advance: displacement forward a cycle over u_max [1], after the first cycle.
        turn: rotation to the left a cycle [rad], after the first cycle.
        off: root mean square, over samples and contacts, of the deviation of the ground reaction
            forces from those at the finest time step, over the robot's weight [1].
        jumps: fraction of the steps in which a ground reaction force changes by more than a fifth
            [1].
    """

    time_step: float
    advance: float
    turn: float
    off: float
    jumps: float

    def __repr__(self):
        return brief(self)


@dataclass(frozen=True, slots=True, eq=False)
class Convergence(ByValue):
    """A robot's walk at each of several time steps, coarsest first."""

    robot: Robot
    rows: tuple[Resolution, ...]

    def __repr__(self):
        most = max(row.off for row in self.rows)
        steps = ", ".join(f"{to_unit(row.time_step, 'ms'):g}" for row in self.rows)
        advance = [row.advance for row in self.rows]
        return (
            f"Convergence(time steps {steps} ms: d/u_max {min(advance):.3f} to "
            f"{max(advance):.3f}, forces deviate by up to {most * 100:.2f} % of the weight)"
        )


def convergence(
    robot: Robot,
    time_steps: Sequence[float] = STEPS,
    *,
    cycles: int = 2,
    settings: Settings | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Convergence:
    """Simulate a walk at several time steps.

    Args:
        time_steps: two or more [s]; the settings' sample is a multiple of each.
        cycles: of each walk, two or more, since the first is left out.
        settings: of the simulation, with another time step; the time constant of contacts is kept.
        progress: called with (done, total), in parts of the work.

    Raises:
        ValueError: fewer than two time steps or cycles, a time step that does not divide the
            sample, or a walk that ended early.
        ModuleNotFoundError: MuJoCo is not installed.
    """
    settings = settings or Settings()
    steps = sorted({float(step) for step in time_steps}, reverse=True)
    if len(steps) < 2:
        raise InputError(f"time_steps = {tuple(time_steps)}: must be two or more different ones.")
    if cycles < 2:
        raise InputError(f"cycles = {cycles}: must be >= 2; the first is left out.")
    for step in steps:
        count = settings.sample / step
        if abs(count - round(count)) > 1e-6:
            raise InputError(
                f"time_steps: {step:g} s does not divide the sample of {settings.sample:g} s."
            )
    costs = [1 / step for step in steps]
    walks: list[Walk] = []
    for i, step in enumerate(steps):

        def report(done: float, of: float, i: int = i) -> None:
            notify(progress, sum(costs[:i]) + done / of * costs[i], sum(costs))

        fine = replace(settings, time_step=step, sample=step)
        one = walk(robot, cycles, settings=fine, progress=report)
        if one.stopped:
            text = f"time_steps: at {step:g} s the walk ended early. {one.stopped}"
            raise InputError(text)
        walks.append(one)
    # Ground reaction forces of each step (n, contacts), and means of samples (samples, contacts).
    forces = [np.concatenate([one.foot_force, one.support_force], axis=1) for one in walks]
    means: list[Floats] = []
    for force, step in zip(forces, steps, strict=True):
        every = round(settings.sample / step)
        windows = force[: len(force) - len(force) % every]
        means.append(windows.reshape(-1, every, force.shape[1]).mean(axis=1))
    rows = tuple(
        Resolution(
            step,
            float(one.advance[1:].mean()),
            float(one.turn[1:].mean()),
            float(np.sqrt(np.mean((mean - means[-1]) ** 2))) / robot.weight,
            _jumps(force),
        )
        for step, one, force, mean in zip(steps, walks, forces, means, strict=True)
    )
    return Convergence(robot, rows)


def _jumps(forces: Floats) -> float:
    larger = np.maximum(np.maximum(forces[1:], forces[:-1]), LOADED)
    return float((np.abs(np.diff(forces, axis=0)) > JUMP * larger).any(axis=1).mean())
