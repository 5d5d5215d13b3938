"""Design of a hopper: the pair of cells on a grid of holes whose snap gives it most energy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from stepwell.base import ByValue, InputError, amount
from stepwell.design import (
    DEFAULT_TOLERANCES,
    BandType,
    Impossible,
    Means,
    StrongestSnap,
    Tolerances,
    Yield,
    strongest_snaps,
    usual_box,
    yields,
)
from stepwell.robot.hopper import Hopper, loaded
from stepwell.robot.hopper_fit import foot_reasons, snap_of
from stepwell.robot.jump import JumpBound, Release, bound_of

# Samples with which the best pairs are compared.
_COMPARED = 200


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class JumpDesign(ByValue):
    """A hopper whose pair of cells sets the most energy free in one snap.

    Attributes:
        hopper: with the found chain.
        means: holes, and stretch, force and friction of one chain.
        found: the pair of one chain.
        snap: of all chains of the hopper together.
        flight: upper bound of what the snap gives, without losses.
        yield_: fraction of samples of the chain with its load that keep the sequence.
    """

    hopper: Hopper
    means: Means
    found: StrongestSnap
    snap: Release
    flight: JumpBound
    yield_: Yield = field(repr=False)

    @property
    def energy_bound(self) -> float:
        """Energy that no pair of the band gives within force and stretch, which is proved [J]."""
        return self.hopper.copies * self.found.bound

    @property
    def of_bound(self) -> float:
        """Energy of the snap over that bound [1]."""
        return self.snap.energy / self.energy_bound

    @property
    def limited_by(self) -> str:
        """The condition behind the smaller bound: "force" or "stretch"."""
        return "force" if self.found.force_bound <= self.found.stretch_bound else "stretch"

    def __repr__(self):
        return f"JumpDesign({self.hopper!r}: {self.found})"


def design_jump(
    hopper: Hopper,
    bands: Sequence[BandType] = (),
    means: Means | None = None,
    *,
    lever: float | None = None,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    sampling: tuple[int | None, int] = (None, 0),
) -> JumpDesign:
    """Search the anchors with which the snap of a hopper sets the most energy free.

    All pairs of cells with the same band on a grid of holes are compared by their energy and the
    probability that tolerances leave the sequence as it is; the best 20 of each band are sampled,
    and the one with the largest energy times yield is taken. The hopper gives the load, the number
    of equal chains, the stretch of its springs and the force of its actuator.

    Args:
        hopper: its chain gives lever, friction and band unless given, and is replaced.
        bands: available bands, of Hooke's law; by default those of the chain.
        means: holes, stretch and force of all chains together; by default 5 mm apart within the
            paper's area scaled with the lever, and the stretch and force of the hopper.
        lever: length of the levers [m].
        tolerances, sampling: of the yield; number of samples (None for the usual one) and seed.

    Raises:
        Impossible: no pair does it; the text has the number of anchors that meet each condition.
        ValueError: a hopper that cannot do its task with any pair.
    """
    cells = hopper.chain.levers
    lever = cells[0].lever if lever is None else lever
    given = usual_means(hopper, lever) if means is None else means
    kinds = tuple(bands) or tuple(dict.fromkeys(BandType.of(b) for c in cells for b in c.bands))
    _refuse(hopper, given, lever)
    copies = hopper.copies
    own = given._replace(force=given.force / copies, friction=max(c.friction for c in cells))
    own = own._replace(spread=tolerances.most.stiffness)
    load, found, failed = hopper.load / copies, list[StrongestSnap](), list[Impossible]()
    for kind in kinds:
        try:
            found += strongest_snaps(kind, own, lever=lever, load=load, unusual=False)
        except Impossible as why:
            failed.append(why)
    if not found:
        raise failed[0]

    def kept(one: StrongestSnap, samples: int | None) -> Yield:
        return yields(loaded(one.chain, 1, load), tolerances, samples=samples, seed=seed)

    samples, seed = sampling
    few = min(samples or _COMPARED, _COMPARED)
    best = max(found, key=lambda one: one.energy * kept(one, few).fraction)
    chain = replace(best.chain, title=hopper.title or "Hopper")
    made = replace(
        hopper,
        chain=chain,
        foot_after=1,
        springs=replace(hopper.springs, stretch=given.stretch),
        actuator=replace(hopper.actuator, force=given.force),
    )
    snap = snap_of(made)
    return JumpDesign(made, own, best, snap, bound_of(made, snap), kept(best, samples))


def usual_means(hopper: Hopper, lever: float) -> Means:
    """Holes of 5 mm within the paper's area, scaled, and the stretch and force of a hopper."""
    box = usual_box(lever)
    return Means(
        depth=box.right, side=box.top, stretch=hopper.springs.stretch, force=hopper.actuator.force
    )


def _refuse(hopper: Hopper, means: Means, lever: float) -> None:
    """Refuse a hopper that no pair of cells on these levers lets do its task."""
    rub = sum(cell.friction for cell in hopper.whole.levers[:2])
    if not means.force > hopper.load + rub:
        raise InputError(
            f"actuator.force = {amount(means.force, 'N', 3)}: must be > "
            f"{amount(hopper.load + rub, 'N', 3)}, weight and friction that the latch and thus the "
            f"actuator holds before the snap; use a stronger actuator or less mass."
        )
    reasons = [*foot_reasons(hopper, math.sqrt(2.0) * lever)]
    if reasons:
        raise InputError("\n".join(reasons))
