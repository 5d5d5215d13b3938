"""A design checked: will the real one do it, what breaks it, and what to measure next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from stepwell.base import ByValue, InputError, percent
from stepwell.design.checks.killer import killer_of_cycle, killer_of_program
from stepwell.design.checks.measurement import Measurement, measurement
from stepwell.design.checks.oddities import oddities
from stepwell.design.checks.verdict import SURE, Verdict, judged
from stepwell.design.margins import LONGEST_FOLLOWED, Change
from stepwell.design.orders import checked_cycle, short
from stepwell.design.tolerances import (
    USUAL,
    Survival,
    Tolerances,
    Yield,
    ends_right,
    survival,
    yields,
)
from stepwell.mechanism import Chain
from stepwell.sequences import Program, cycle
from stepwell.statics import Path


@dataclass(frozen=True, eq=False)
class Check(ByValue):
    """One verdict on a design, and what it rests on.

    Attributes:
        chain: the design.
        verdict: whether the real one will do what is wanted.
        reason: why, in a sentence.
        wanted: the full cycle that counts; or where its program begins and where it shall end.
        does: what the drawing does.
        does_it: whether that is what is wanted.
        path: what the actuator does with the drawing, with forces, energy and ties.
        yield_: how many of those built within tolerances do it.
        killer: the smallest change of one thing after which the drawing does something else, in
            tolerances; None where there is none within reach, or it does not do it as it is.
        oddities: what is out of the ordinary, a sentence each.
        measure: the one measurement after which it is surest to work; None where none is worth it.
    """

    chain: Chain = field(repr=False)
    verdict: Verdict
    reason: str
    wanted: str
    does: str
    does_it: bool
    path: Path = field(repr=False)
    yield_: Yield | Survival
    killer: Change | None
    oddities: tuple[str, ...]
    measure: Measurement | None

    @property
    def peak_force(self) -> float:
        """Largest force of the actuator in size [N], with its sign."""
        return self.path.peak_force

    @property
    def dissipated(self) -> float:
        """Energy lost in the cycle or the program [J]: snaps and friction."""
        return self.path.dissipated

    def __repr__(self):
        return f"Check({self.verdict}: {self.reason})"


def check(
    chain: Chain,
    want: str | Program | None = None,
    tolerances: Tolerances = USUAL,
    *,
    samples: int | None = None,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Check:
    """Say whether the real one will do what is wanted, what breaks it, and what to measure next.

    Args:
        chain: the design.
        want: the full cycle that counts, such as "00>10>11>01>00", or a program of this chain; the
            cycle of the drawing by default.
        tolerances: how far the parts may be from the drawing; as for `yields` by default.
        samples: how many mechanisms are made at random; as many as for `yields`, or for `survival`,
            by default.
        seed: which ones.
        progress: called with (done, samples) while they are counted.

    Returns:
        The verdict with its reasons.

    Raises:
        ValueError: no such cycle, a program of another chain, or tolerances as for `yields`.
        StaticsError: the engine could not follow the drawing; the text says where and what to do.

    Source: ours; the rule is the decision "A verdict is an interval's".
    """
    if isinstance(want, Program):
        if want.chain != chain:
            raise InputError("want: must be a program of this chain, and is one of another.")
        return _of_program(want, tolerances, samples, seed, progress)
    motion = cycle(chain)
    path, does = motion.path, str(motion.sequence)
    wanted = does if want is None else checked_cycle(want, chain.last_state, "want")
    found = yields(chain, tolerances, n=samples, seed=seed, wanted=wanted, progress=progress)
    killer = killer_of_cycle(chain, tolerances) if does == wanted else None
    return _told(path, wanted, does, does == wanted, found, killer)


def _of_program(
    program: Program,
    tolerances: Tolerances,
    samples: int | None,
    seed: int,
    progress: Callable[[int, int], None] | None,
) -> Check:
    chain, points, start, to = program.chain, program.turning_points, program.start, program.to
    found = survival(
        chain, points, to, tolerances, start=start, n=samples, seed=seed, progress=progress
    )
    does_it = ends_right(chain, points, start, to)
    killer = killer_of_program(program, tolerances) if does_it else None
    does = f"{start} to {to if does_it else program.arrives}"
    return _told(program.path, f"{start} to {to}", does, does_it, found, killer)


def _told(
    path: Path,
    wanted: str,
    does: str,
    does_it: bool,
    found: Yield | Survival,
    killer: Change | None,
) -> Check:
    tied = bool(path.degenerate)
    verdict = judged(does_it=does_it, tied=tied, interval=found.interval)
    low, high = map(percent, found.interval)
    if not does_it:
        reason = f"the drawing itself does {short(does)}"
    elif verdict is Verdict.WORKS:
        reason = f"the drawing does it, and so do at least {low} of those built"
    elif verdict is Verdict.WONT:
        reason = f"the drawing does it, but at most {high} of those built do"
    elif tied:
        reason = "the drawing is a tie: the model cannot tell which of two things it does"
    elif found.share >= SURE:
        reason = f"too few were made to be sure: {low} to {high} of those built do it"
    else:
        reason = f"the drawing does it, but only {low} to {high} of those built do"
    if killer is not None and len(found.chain) <= LONGEST_FOLLOWED:
        # Found here, once: reports only read it.
        _ = killer.becomes
    worth = measurement(found) if does_it and not tied else None
    odd = oddities(found.chain, path)
    return Check(
        found.chain, verdict, reason, wanted, does, does_it, path, found, killer, odd, worth
    )
