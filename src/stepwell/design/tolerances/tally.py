"""Outcomes of random samples, counted, and the reason for a yield of zero."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, ByValue, Floats, Ints, Progress, notify, tracked
from stepwell.concave import ASK, DOES, OTHER, TIE, DrawJudge, SampleVerdicts, one_travel
from stepwell.design.orders import numbered_cycle, orders_of, short
from stepwell.design.switches import Switches, are_relays, relay_cycle
from stepwell.design.targets import landings_of_reachable, reachable_states, state_differences
from stepwell.design.tolerances.draws import Draws, Tolerances
from stepwell.mechanism import Chain
from stepwell.sequences import Sequence, cycle, cycles_of
from stepwell.statics import Landing, StaticsError

_LEVERS = "anchors, levers and friction uniform within their tolerances, k and ℓ0 normal"
_ELEMENTS = "one normal factor for all forces of an element and one for its travels"


def sampling_text(chain: Chain) -> str:
    """Assumed distributions of the samples, in words."""
    how = _LEVERS
    if chain.elements:
        levers = len(chain.elements) < len(chain)
        how = f"{_LEVERS if levers else 'friction uniform within its tolerance'}, {_ELEMENTS}"
    return f"independent parameters: {how}; quasi-static"


class Fraction(NamedTuple):
    """A fraction of independent random designs, with its confidence interval.

    Attributes:
        times, of: number of successes, and of designs.
        low, high: 95 % confidence interval of the fraction (Clopper & Pearson 1934).
    """

    times: int
    of: int
    low: float
    high: float

    @property
    def estimate(self) -> float:
        """Successes over designs."""
        return self.times / self.of


def fraction_of(times: int, of: int) -> Fraction:
    """The fraction `times` / `of` with its interval."""
    # Importing scipy.stats, which also has this interval, takes a second.
    from scipy.special import betaincinv  # pyright: ignore[reportMissingTypeStubs]

    low = float(betaincinv(times, of - times + 1, 0.025)) if times else 0.0
    high = float(betaincinv(times + 1, of - times, 0.975)) if times < of else 1.0
    return Fraction(times, of, low, high)


@dataclass(frozen=True, eq=False, kw_only=True)
class Counted(ByValue):
    """Number of successes among random samples of a nominal design."""

    chain: Chain = field(repr=False)
    tolerances: Tolerances
    samples: int
    seed: int
    successes: int

    @property
    def fraction(self) -> float:
        """Successes over samples: the estimate of the probability."""
        return self.successes / self.samples

    @cached_property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the probability (Clopper & Pearson 1934)."""
        return fraction_of(self.successes, self.samples)[2:]


@dataclass
class RelayJudge:
    """Outcomes of many samples of elements that are relays under a prescribed force.

    Their switching forces scale with all forces of an element, and shift with friction.
    """

    draws: Draws
    target: str
    orders: Ints | None  # (2, T) of the target; None if two switch at once
    # Cycles with their numbers in `SampleVerdicts.does`.
    texts: dict[str, int] = field(default_factory=dict[str, int])

    def __call__(self, drawn: Floats) -> SampleVerdicts:
        """Outcomes of draws (m, columns)."""
        forces = self.draws.switching_forces(drawn)
        motion = Switches.of(self.draws.chain.last_state).motion(forces)
        cycles, which = motion.cycles()
        does = np.array([self.texts.setdefault(text, len(self.texts)) for text in cycles])[which]
        right = np.array([text == self.target for text in cycles])[which]
        verdict = np.where(motion.tied, TIE, np.where(right, DOES, OTHER)).astype(np.int8)
        gap, wrong = np.full(len(drawn), np.inf), np.zeros((2, 0), np.int64)
        narrowest = wrong
        if self.orders is not None and forces.shape[1] > 1:
            gaps = gaps_between(forces, self.orders)
            gap = np.min(gaps, axis=(1, 2))
            wrong = np.sum((gaps < 0) & (verdict == OTHER)[:, None, None], axis=0)
            nearest = np.argmin(gaps.reshape(len(gaps), -1), axis=1)
            narrowest = np.bincount(nearest, minlength=wrong.size).reshape(wrong.shape)
        return SampleVerdicts(verdict, does, gap, wrong, narrowest)


def gaps_between(forces: Floats, orders: Ints) -> Floats:
    """(m, 2, T - 1) gaps [N], of forces (m, T, 2), between neighbours of two orders (2, T)."""
    up, down = forces[:, orders[0], 0], -forces[:, orders[1], 1]
    return np.diff(np.stack([up, down], axis=1), axis=2)


# Outcomes of a sample other than a sequence.
TIED = "a tie"
NOT_BUILT = "cannot be built"
NO_ANSWER = "no answer"
ANOTHER = "another sequence"
BY_MOBILITY = "depends on the mobilities"

States = frozenset[str] | None  # target states; None for a cycle
_MOST_CELLS = 9  # the two orders of more cells exceed one 64-bit number
_MOST_OUTCOMES = 100  # distinguished


def simulated_outcomes(
    draws: Draws, drawn: Floats, states: States = None, progress: Progress = None
) -> Iterator[str]:
    """Simulated outcomes of (m, columns) draws: cycles, or differences from the target states."""
    forced = draws.chain.elements and draws.chain.actuator_stiffness == 0
    if states is None and not forced:
        designs = draws.designs(drawn)
        cycles = cycles_of(lambda i: draws.built(drawn[i]), len(drawn), designs, progress)
        # IMPOSSIBLE and UNSOLVED count from the end.
        texts = [*map(str, cycles.sequences), NO_ANSWER, NOT_BUILT]
        for number, tied in zip(cycles.number.tolist(), cycles.tied.tolist(), strict=True):
            yield TIED if tied and number >= 0 else texts[number]
        return
    for draw in tracked(drawn, progress):
        yield _simulated_outcome(draws, draw, states)


def _simulated_outcome(draws: Draws, draw: Floats, states: States) -> str:
    try:
        sample = draws.built(draw)
    except ValueError:
        return NOT_BUILT
    try:
        if states is not None:
            reached_states, ties = reachable_states(sample)
            return TIED if ties else state_differences(reached_states, states)
        by_forces = relay_cycle(sample)
        if by_forces is not None:
            return by_forces
        result = cycle(sample)
    except (StaticsError, ValueError):
        return NO_ANSWER
    return TIED if result.degenerate else str(result.sequence)


def landings_to_target(
    draws: Draws, draw: Floats, states: States, ratio: float
) -> Iterable[Landing]:
    """Landings of the snaps of one sample, for all mobilities within a ratio.

    Snaps of its cycle, or for target states of all branches to them. None if switching forces
    decide under a prescribed force: the cells are then independent for any mobilities.
    """
    sample = draws.built(draw)
    if states is not None:
        return landings_of_reachable(sample, ratio)
    return () if relay_cycle(sample) is not None else cycle(sample).path.landings(ratio)


class OutcomeCounter:
    """Outcomes of the first n samples, counted against the target."""

    def __init__(
        self, draws: Draws, target: str, states: States = None, robust: float | None = None
    ):
        self.draws, self.orders = draws, orders_of(target)
        # Success: exactly the target states, or the target cycle; with a ratio, all landings on the
        # way must also hold for all mobilities within it.
        self.states, self.robust = states, robust
        self._success = target if states is None else ""
        chain, count = draws.chain, len(Switches.of(draws.chain.last_state))
        # If every two loops are nested, all states are reached (theory page, "Stroke programs").
        whole = states is not None and len(states) == 2**count and not chain.elements
        self._nested_do = whole and one_travel(chain) and not draws.tolerances.most.lever
        self.judge: DrawJudge | RelayJudge | None = None
        if not chain.elements:
            some = self.orders if self.orders is not None else np.tile(np.arange(count), (2, 1))
            self.judge = DrawJudge.of(chain, draws.spread, some)
        elif len(chain.elements) == len(chain) and are_relays(chain):
            self.judge = RelayJudge(draws, target, self.orders)
        # Successes are proved if no landing was only sampled. In the closed form none depends on
        # the mobilities.
        self.successes = self.proved = self.by_form = self.by_engine = 0
        self.succeeded: list[bool] = []  # of each simulated sample, in order
        self.wrong = np.zeros((2, max(count - 1, 0)), np.int64)  # as `Judge` counts them
        self.narrowest = self.wrong.copy()
        self._numbered = len(chain) <= _MOST_CELLS
        self._texts: Counter[str] = Counter()
        self._numbers: list[Ints] = [np.empty(0, np.int64)]

    def count(self, n: int, progress: Progress) -> None:
        """Count the first n; `progress` is called with (done, n)."""
        done = 0
        for drawn in self.draws.chunks(n):
            waiting = drawn if self.judge is None else drawn[self._count_proved(drawn, self.judge)]
            done += len(drawn) - len(waiting)

            def tell(m: int, _: int, begun: int = done) -> None:
                notify(progress, begun + m, n)

            tell(0, n)
            outcomes = simulated_outcomes(self.draws, waiting, self.states, tell)
            for draw, does in zip(waiting, outcomes, strict=True):
                self._count_one(draw, does)
            done += len(waiting)
            tell(len(waiting), n)

    def _count_proved(self, drawn: Floats, judge: DrawJudge | RelayJudge) -> Bools:
        """Count samples that the closed form decides; returns which ones it does not."""
        verdicts = judge(drawn)
        ask = verdicts.verdict == ASK
        self.by_form += int(np.sum(~ask))
        if verdicts.wrong.size:
            self.wrong += verdicts.wrong
            self.narrowest += verdicts.narrowest
        if self.states is not None and isinstance(judge, RelayJudge):
            return np.ones_like(ask)
        if self.states is not None:
            halves = np.divmod(verdicts.does, len(self.draws.chain) ** len(self.draws.chain))
            nested = ~ask & (verdicts.verdict != TIE) & (halves[0] == halves[1]) & self._nested_do
            self._succeed(int(np.sum(nested)))
            return ~nested
        self._texts[TIED] += int(np.sum(verdicts.verdict == TIE))
        does, other = verdicts.verdict == DOES, verdicts.verdict == OTHER
        if self.orders is None and isinstance(judge, DrawJudge):
            does, other = np.zeros_like(does), does | other
        self._succeed(int(np.sum(does)))
        if self._numbered:
            self._numbers.append(verdicts.does[other])
        else:
            self._texts[ANOTHER] += int(np.sum(other))
        return ask

    def _count_one(self, draw: Floats, does: str) -> None:
        self.by_engine += 1
        proved = True
        # A gap between forces decides the sequence and does not depend on the mobilities.
        self.succeeded.append(does == self._success)
        if does == self._success and self.robust is not None:
            for landing in landings_to_target(self.draws, draw, self.states, self.robust):
                if not landing.holds:
                    does = BY_MOBILITY
                    break
                proved = proved and landing.proof is not None
        if does == self._success:
            self._succeed(1, proved=proved)
        else:
            kinds = (TIED, NOT_BUILT, NO_ANSWER, BY_MOBILITY)
            known = self._numbered or self.states is not None or does in kinds
            self._texts[does if known else ANOTHER] += 1

    def _succeed(self, times: int, *, proved: bool = True) -> None:
        self.successes += times
        self.proved += times * proved

    def outcomes(self) -> dict[str, int]:
        """Outcomes of the failures, most frequent first; the rarest are counted as one."""
        counts = +self._texts  # without counts of 0
        numbers, times = np.unique(np.concatenate(self._numbers), return_counts=True)
        often = np.argsort(-times, kind="stable")
        for i in often[:_MOST_OUTCOMES]:
            counts[self._cycle(int(numbers[i]))] += int(times[i])
        rest = int(np.sum(times[often[_MOST_OUTCOMES:]])) + counts.pop(ANOTHER, 0)
        listed = sorted(counts.items(), key=lambda item: (-item[1], item[0]))
        rest += sum(times for _, times in listed[_MOST_OUTCOMES:])
        return dict(listed[:_MOST_OUTCOMES]) | ({ANOTHER: rest} if rest else {})

    def _cycle(self, number: int) -> str:
        if isinstance(self.judge, RelayJudge):
            return list(self.judge.texts)[number]
        return numbered_cycle(number, len(self.draws.chain))


def zero_yield_reason(chain: Chain, target: str, concave: bool) -> str:
    """Reason why no sample makes a cycle, and advice; `concave` if all cells are proved so."""
    if chain.elements:
        return f"no sample reaches the target. Choose another cycle, {_alternative(chain)}"
    states = Sequence.parse(target).states
    strokes = [
        math.fsum(full for full, s in zip(chain.full_travels, state, strict=True) if s == "1")
        for state in states
    ]
    top = states.index("1" * len(chain))
    for k, (a, b) in enumerate(pairwise(strokes)):
        if (b <= a) if k < top else (b >= a):
            way = "rise" if k < top else "fall"
            return (
                f"one full cycle cannot give the target: from {states[k]} to {states[k + 1]} the "
                f"stroke does not {way}. A stroke program with early reversals can: see `stepwell "
                f"program`, in Python chain.program, and for its yield `stepwell yield --program`"
            )
    for (a, b), flips in zip(pairwise(states), Sequence.parse(target).flips, strict=True):
        if concave and len(flips) > 1:
            return (
                f"one full cycle cannot give the target: {a}>{b} moves {len(flips)} cells at "
                f"once, but cells with falling force move one at a time. Write every step, "
                f"{_alternative(chain)}. For a program that ends in {b} see "
                f"`stepwell program --target {b}`"
            )
    return f"no sample reaches the target. Choose another cycle, {_alternative(chain)}"


def _alternative(chain: Chain) -> str:
    try:
        return f"such as {short(str(cycle(chain).sequence))}, that of the nominal design"
    except StaticsError:
        return "one with a step for each cell"
