"""Everything that is tried to make a chain do what is wanted, one thing after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from stepwell.design.orders import Target
from stepwell.design.placement import Region, Rule, all_proved, told
from stepwell.design.synthesis.attempt import Attempt, look
from stepwell.design.synthesis.impossible import Impossible, nothing_works
from stepwell.design.synthesis.others import another
from stepwell.design.synthesis.remaining import tried
from stepwell.design.tolerances import Tolerances, yields
from stepwell.mechanism import Chain

_REFINED = 3  # attempts
# Of choices that do it, so many are made so often, to see which does it most surely.
_COMPARED, _MADE = 24, 40


@dataclass(frozen=True, eq=False)
class Placed:
    """What came of choosing from what the closed form decides.

    Attributes:
        found: the best attempt that does what is wanted by the engine; None if none does.
        attempts: all of them.
        complete: whether no choice was left out, so that none is better by the objective, and
            there is none where none was found.
        missed: what the engine finds of a better one.
        others: how many random choices in the wanted orders were looked at.
    """

    found: Attempt | None
    attempts: list[Attempt]
    complete: bool
    missed: str
    others: int

    @property
    def candidates(self) -> int:
        """How many ways to build a cell were looked at first."""
        return max((attempt.candidates for attempt in self.attempts), default=0)


@dataclass
class Tries:
    """The tries at one target, with their progress.

    Args:
        target: what is wanted.
        regions, holes: where anchors may be, pitch [m].
        actuator_stiffness: K [N/m].
        seed: of what is random.
        progress: called with (done, total).
        rules: how many sets of bands and levers there are.
        free: which anchors are placed.
    """

    target: Target
    regions: tuple[Region, ...]
    holes: float | None
    actuator_stiffness: float
    seed: int
    progress: Callable[[int, int], None] | None
    rules: int
    free: str = "q"
    _done: int = field(default=0, init=False)

    @property
    def _total(self) -> int:
        once = self.rules * len(self.target.wish.orders) + _REFINED
        # Among holes there may be a second round, and then the rest.
        return once + 1 if self.holes is None else 2 * once + 100 + 1

    def _tell(self, step: int = 1) -> None:
        self._done = min(self._done + step, self._total)
        if self.progress is not None:
            self.progress(self._done, self._total)

    def end(self) -> None:
        """Nothing is left to be tried."""
        self._tell(self._total)

    def placed(self, rules: list[Rule]) -> Placed:
        """The best choice by the objective that does what is wanted."""
        target, attempts = self.target, list[Attempt]()
        for rule in rules:
            for orders in target.wish.orders:
                self._tell()
                attempts.append(look(rule, orders, self.regions, self.holes))
        attempts.sort(key=lambda attempt: attempt.quality, reverse=True)
        for k in range(min(_REFINED, len(attempts))):
            self._tell()
            attempts[k] = attempts[k].refined()
        attempts.sort(key=lambda attempt: attempt.quality, reverse=True)
        complete = target.wish.complete and self.holes is not None
        complete = complete and not any(rule.bends for rule in rules)
        complete = complete and all(attempt.complete for attempt in attempts)
        missed = ""
        for attempt in attempts:
            if not attempt.works:
                continue
            chain = attempt.chain(self.actuator_stiffness, "")
            fault = target.fault(chain, attempt.orders)
            if not fault:
                return Placed(attempt, attempts, complete and not missed, missed, 0)
            missed = missed or fault
        found, others = None, 0
        if missed:
            found, others = another(target, attempts, self.actuator_stiffness, self.seed)
        return Placed(found, attempts, complete and not missed, missed, others)

    def rest(self, rules: list[Rule], placed: Placed, tolerances: Tolerances) -> tuple[Chain, str]:
        """A chain that does it among what the closed form does not decide, and how it was found.

        Raises:
            Impossible: there is none, or none was found.
        """
        target = self.target
        if self.holes is None:
            concave = not target.wish.stepwise and all(
                all_proved(rule, region) for rule in rules for region in set(self.regions)
            )
            looked = f"{placed.others} random choices in the wanted orders were looked at"
            raise self._refusal(
                placed, looked * (placed.others > 0), proved=target.wish.never or concave
            )
        if target.wish.never or (not target.wish.orders and target.states is None):
            raise self._refusal(placed, "", proved=target.wish.never)
        before = self._done
        found = tried(
            target,
            rules,
            self.regions,
            self.holes,
            decided=placed.complete and target.states is None,
            actuator_stiffness=self.actuator_stiffness,
            seed=self.seed,
            progress=lambda done, all_: self._tell(
                max(0, before + 100 * done // max(all_, 1) - self._done)
            ),
        )
        if not found.chains:
            raise self._refusal(placed, found.report, proved=found.all)
        surest = max(found.chains[:_COMPARED], key=lambda chain: self._share(chain, tolerances))
        return surest, (
            f"searched: no choice of {placed.candidates} holes for a band that is proved taut and "
            f"concave does it; {found.report}, and {len(found.chains)} of them do it; the one of "
            f"{min(len(found.chains), _COMPARED)} of these that works most often of {_MADE} built"
        )

    def _share(self, chain: Chain, tolerances: Tolerances) -> float:
        counted = None if self.target.states is None or tolerances.friction else self.target.states
        return yields(chain, tolerances, n=_MADE, seed=self.seed, wanted=counted).share

    def _refusal(self, placed: Placed, rest: str, *, proved: bool) -> Impossible:
        allowed = told(self.regions, self.holes, self.free)
        return nothing_works(
            self.target, placed.attempts, placed.missed, rest, allowed, proved=proved
        )
