"""The probability that a built mechanism does what it was designed for."""

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from stepwell import base, sequences, statics
from stepwell.design.orders import by_cells_at_1, checked_cycle, is_state, short
from stepwell.design.switches import Switches, switching_forces
from stepwell.design.targets import reached, unsearchable
from stepwell.design.tolerances import draws, survival
from stepwell.design.tolerances.draws import Draws
from stepwell.design.tolerances.sensitivity import Sensitivities, gaps_of_built, sensitivities
from stepwell.design.tolerances.tally import (
    BY_MOBILITY,
    Counted,
    OutcomeCounter,
    RelayJudge,
    sampling_text,
    zero_yield_reason,
)
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    import xarray as xr


_SHOWN = 4  # outcomes printed
_COMPARED = 1000  # mechanisms of which the gap is compared with what they do


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Critical(base.ByValue):
    """The two cells whose order goes wrong first.

    Attributes:
        first, second: the numbers of the cells; `first` should move before `second`.
        names: what they are called; where cells have more than two phases, with these.
        way: "loading", decided by F0 plus friction, or "unloading", by F1 less friction.
        share: of the mechanisms judged in closed form, how many have them in the other order.
        narrowest: in how many their gap is the smallest of all.
        by: the force that decides: "F0", "F1", or that of the switches up or down.
    """

    first: int
    second: int
    names: tuple[str, str]
    way: str
    share: float
    narrowest: float
    by: str = ""

    def __str__(self):
        before, after = self.names
        return (
            f"{before} before {after} while {self.way} ({self.by}): "
            f"in the other order in {base.percent(self.share)}"
        )


@dataclass(frozen=True, eq=False)
class Yield(Counted, base.Drawn):
    """How many mechanisms, sampled within tolerances, reach the target.

    Attributes:
        chain, tolerances: the drawing, and how far the parts may be from it.
        samples, seed: how many mechanisms, and which.
        share, interval: successes over samples, and the 95 % confidence interval of the probability
            (Clopper & Pearson 1934).
        target: the sequence of states of a full cycle; or "states", and those wanted.
        states: those that shall be in reach from all cells at 0 and no others; None for a cycle.
        successes: how many do it, without a tie.
        outcomes: what the others do, most frequent first: a sequence, or which states they reach
            beside those wanted and which not; "a tie", "cannot be built", "no answer" from the
            engine, "another sequence" for all that are not told apart (chains of ten cells or
            more, the rarest ones).
        critical: the neighbours in the wanted order that are most often in the other order, or
            nearest to it; None where nothing was judged in closed form, or there is no such pair.
        by_engine: how many were followed by the general engine.
        robust: the ratio of mobilities for which each has to do it; None for those it has.
        proved: how many of the successes do it for all of these by proof: the closed form asks for
            no mobility, and landings say for themselves. Of the others some landings were only
            sampled. None where `robust` is.
        assumptions: under which all this holds.
        sensitivities: which part's tolerance counts; None unless asked for.
        advice: where none does what is wanted, why, and what to ask for instead; else "".
    """

    target: str
    states: tuple[str, ...] | None
    outcomes: Mapping[str, int]
    critical: Critical | None
    by_engine: int
    robust: float | None
    proved: int | None
    assumptions: str
    sensitivities: Sensitivities | None
    advice: str = ""

    def mechanism(self, number: int) -> Chain:
        """One of the n mechanisms, from 0; ValueError for no such number or no such mechanism."""
        if not 0 <= number < self.samples:
            raise base.InputError(f"number = {number}: must be between 0 and {self.samples - 1}.")
        return Draws(self.chain, self.tolerances, self.seed).sample(number)

    def end_forces(self, n: int = 1000) -> base.Floats:
        """Forces at which the cells of the first n mechanisms let go, for a cloud around each.

        (m, T, 2) F0 plus friction and F1 less friction [N], of elements the forces up and down of
        each switch; T = N for cells of two phases, m = min(n, self.samples), NaN where none can be
        built.
        """
        forces = np.full((min(n, self.samples), *switching_forces(self.chain).shape), np.nan)
        for number in range(len(forces)):
            with suppress(ValueError):
                forces[number] = switching_forces(self.mechanism(number))
        return forces

    def to_xarray(self) -> "xr.Dataset":
        """Counts over "outcome", the wanted one first, and indices over "parameter"."""
        base.need("tables")
        import xarray as xr

        counts, table = self._counts, self.sensitivities
        data = {"count": ("outcome", np.array([*counts.values()]), {"units": "1"})}
        coords = {"outcome": np.array([*counts], str)}
        if table is not None:
            data["first_order"] = ("parameter", table.first_order, {"units": "1"})
            data["total"] = ("parameter", table.total, {"units": "1"})
            coords["parameter"] = np.array(table.parameters, str)
        attrs = {
            "title": self.chain.title or "yield",
            "target": self.target,
            "share": self.share,
            "interval_95": [*self.interval],
            "samples": self.samples,
            "seed": self.seed,
            "tolerances": repr(self.tolerances),
            "critical": str(self.critical or ""),
            "by_engine": self.by_engine,
            "chain": repr(self.chain),
            "assumptions": self.assumptions,
            "source": f"stepwell {base.__version__}, yields",
        }
        return xr.Dataset(data, coords, attrs)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write one line an outcome, the wanted one first."""
        counts = self._counts.values()
        shares = [count / self.samples for count in counts]
        columns = [base.Quantity("outcome"), base.Quantity("count"), base.Quantity("share", "1")]
        base.write_csv(path, zip(columns, (self._counts, counts, shares), strict=True), 9)

    @property
    def _counts(self) -> dict[str, int]:
        return {self.target: self.successes, **self.outcomes}

    def __str__(self):
        low, high = map(base.percent, self.interval)
        lines = [
            f"{base.percent(self.share)} of {self.samples} mechanisms do {short(self.target)} "
            f"(95 % confidence: {low} to {high})"
        ]
        if self.advice:
            lines.append(self.advice)
        shown = list(self.outcomes.items())[:_SHOWN]
        lines += [f"{base.percent(count / self.samples)}: {short(text)}" for text, count in shown]
        if len(self.outcomes) > _SHOWN:
            lines.append(f"and {len(self.outcomes) - _SHOWN} other outcomes")
        if self.critical is not None:
            lines.append(f"critical: {self.critical}")
        if self.sensitivities is not None:
            lines += ["share of the variance of the smallest gap:", str(self.sensitivities)]
        return "\n".join([*lines, self.assumptions])

    def __repr__(self):
        low, high = map(base.percent, self.interval)
        return (
            f"Yield({short(self.target)}: {base.percent(self.share)} of {self.samples}, "
            f"{low} to {high}, {self.tolerances!r})"
        )


def yields(
    chain: Chain,
    tolerances: draws.Tolerances = draws.USUAL,
    *,
    samples: int | None = None,
    seed: int = 0,
    target: str | Iterable[str] | None = None,
    sensitivity: bool = False,
    robust: float | None = None,
    progress: base.Progress = None,
) -> Yield:
    """Make a mechanism n times at random within its tolerances and count those that work.

    All else as for `Chain.yields`.
    """
    _check_arguments(chain, tolerances, base.ONE_BY_ONE if samples is None else samples, seed)
    robust = None if robust is None else statics.checked_ratio("robust", robust)
    states = _checked_states(chain, tolerances, target)
    drawing = sequences.cycle(chain) if target is None or states is not None else None
    sequence = str(drawing.sequence) if drawing else checked_cycle(str(target), chain.last_state)
    tally = OutcomeCounter(Draws(chain, tolerances, seed), sequence, states, robust)
    if sensitivity and tally.orders is None:
        raise base.InputError(
            f"sensitivity = True: neighbours in an order are compared, and {short(sequence)} has "
            f"none, since not every step moves one cell; leave it out, or ask for another cycle."
        )
    if samples is None:
        samples = base.QUICKLY if states is None and tally.judge is not None else base.ONE_BY_ONE
    tally.count(samples, progress)
    listed = None if states is None else by_cells_at_1(states)
    counted = {"chain": chain, "tolerances": tolerances, "samples": samples, "seed": seed}
    return Yield(
        sequence if listed is None else f"states {' '.join(listed)}",
        listed,
        base.ReadOnly(tally.outcomes()),
        _critical(tally),
        tally.by_engine,
        robust,
        None if robust is None else tally.proved,
        "; ".join(filter(None, _assumptions(tally, samples, drawing))),
        _sensitivities(tally, samples) if sensitivity else None,
        _advice(tally, sequence),
        successes=tally.successes,
        **counted,
    )


def _checked_states(
    chain: Chain, tolerances: draws.Tolerances, target: str | Iterable[str] | None
) -> frozenset[str] | None:
    if target is None or isinstance(target, str):
        return None
    states = frozenset(str(state) for state in target)
    if not states or not all(is_state(state, chain.last_state) for state in states):
        digits = f"digits up to {chain.last_state}" if chain.elements else "characters 0 or 1"
        raise base.InputError(
            f"target = {sorted(states)}: must be states of {len(chain)} {digits}, one a "
            f"cell, inner first."
        )
    why = unsearchable(chain, tolerances.friction)
    if why:
        raise base.InputError(
            f"target = {short(' '.join(sorted(states)))}: {why}; ask for a full cycle instead."
        )
    return states


def _check_arguments(chain: Chain, tolerances: draws.Tolerances, samples: int, seed: int) -> None:
    if not isinstance(tolerances, draws.Tolerances):
        raise base.InputError(
            f"tolerances = {tolerances!r}: must be Tolerances, for example "
            f"Tolerances(anchor=0.0005, stiffness=0.05)."
        )
    base.check.whole("samples", samples, 1)
    base.check.whole("seed", seed, 0)
    base.require("samples", samples, "samples =")
    shortest = min((cell.lever for cell in draws.levers_of(chain)), default=np.inf)
    if tolerances.lever >= shortest:
        raise base.InputError(
            f"lever = {tolerances.lever} m: must be smaller than the shortest lever, "
            f"{shortest:.6g} m, or nothing is left of it."
        )
    draws.validate(tolerances, chain)


def _advice(tally: OutcomeCounter, target: str) -> str:
    if tally.successes:
        return ""
    if tally.outcomes().get(BY_MOBILITY):
        return (
            "none of those made does it whatever the mobilities of its cells: ask for a smaller "
            "ratio; or in Python, with Tolerances(mobility=...), how often it works"
        )
    if tally.states is None:
        return zero_yield_reason(tally.draws.chain, target, tally.by_engine == 0)
    states = reached(tally.draws.chain)
    return f"none of those made does it; the drawing reaches {short(' '.join(states.states))}"


def _sensitivities(tally: OutcomeCounter, n: int) -> Sensitivities:
    draws, judge, orders = tally.draws, tally.judge, tally.orders
    if judge is not None:
        return sensitivities(draws, lambda rows: judge(rows).gap)
    assert orders is not None
    indices = sensitivities(draws, lambda rows: gaps_of_built(draws, orders, rows), built=True)
    # The engine followed every one, so it can be asked how far the gap is to be believed.
    some = np.array(tally.succeeded[:_COMPARED])
    gaps = gaps_of_built(draws, orders, next(draws.chunks(n))[: len(some)])
    return replace(indices, agreed=float(np.mean((gaps > 0) == some[: len(gaps)])))


def _critical(tally: OutcomeCounter) -> Critical | None:
    """The pair most often in the other order; of several, the one most often the nearest."""
    if not tally.by_form or tally.orders is None or not tally.wrong.size:
        return None
    wrong, narrowest = tally.wrong.ravel(), tally.narrowest.ravel()
    worst = int(np.lexsort((narrowest, wrong))[-1])
    side, place = divmod(worst, tally.orders.shape[1] - 1)
    first, second = tally.orders[side, place : place + 2].tolist()
    chain = tally.draws.chain
    switches = Switches.of(chain.last_state)
    cell, names = switches.cell.tolist(), switches.names(chain)
    way = ("loading", "unloading")[side]
    by = ("the forces up", "the forces down") if chain.elements else ("F0", "F1")
    shares = int(wrong[worst]) / tally.by_form, int(narrowest[worst]) / tally.by_form
    pair = names[first], names[second]
    return Critical(cell[first], cell[second], pair, way, *shares, by[side])


def _assumptions(tally: OutcomeCounter, n: int, drawing: sequences.Cycle | None) -> Iterator[str]:
    if tally.states is not None:
        how = (
            f"{tally.by_engine} followed along every branch by the general engine"
            + (n > tally.by_engine)
            * f", {n - tally.by_engine} proved to reach all states, every two loops being nested"
        )
    elif isinstance(tally.judge, RelayJudge):
        how = (
            f"{tally.by_form} judged by their switching forces, which decide under a prescribed "
            f"force, where no element feels another"
        )
    elif tally.judge is None and tally.draws.chain.elements:
        how = f"the general engine followed all {n}, since elements move together as the drive goes"
    elif tally.judge is None:
        how = (
            f"no closed form for such cells (several bands, a bent law or a load), so the general "
            f"engine followed all {n}"
        )
    else:
        how = (
            f"{tally.by_form} judged in closed form, every cell being proved taut with falling "
            f"force, and {tally.by_engine} followed by the general engine"
        )
    sampling = sampling_text(tally.draws.chain) + " full cycle" * (tally.states is None)
    fails = "a tie, or a mechanism that cannot be built or followed, counts as a failure"
    yield f"{sampling}; {fails}; {how}"
    if tally.robust is not None:
        sampled = tally.successes - tally.proved
        rest = f", and {sampled} had landings that were only sampled" * (sampled > 0)
        proved = f": of {tally.proved} that is proved{rest}" * (tally.successes > 0)
        ratio = f"up to {tally.robust:g} apart"
        yield f"counted is what works for all mobilities of the cells {ratio}{proved}"
    yield draws.frictionless(tally.draws.tolerances, tally.draws.chain)
    yield "the drawing is a tie" if drawing and drawing.degenerate else ""


def parts_of(counted: Yield | survival.Survival) -> dict[str, draws.Part]:
    """The parts that vary in what was counted, by their names, such as "outer.stiffness"."""
    return Draws(counted.chain, counted.tolerances, counted.seed).parts


def with_tightened_tolerance(
    counted: Yield | survival.Survival, part: str, left: float, n: int
) -> int:
    """How many of the first n mechanisms work where one part has the share `left` of its tolerance.

    The same mechanisms are made with the same luck; only that part, named as in `parts_of`, is
    nearer to its drawing, and friction to the middle of its tolerance.
    """
    draws = Draws(counted.chain, counted.tolerances, counted.seed, part, left)
    if isinstance(counted, survival.Survival):
        return survival.count_ends(draws, counted.turning_points, counted.start, counted.target, n)
    states = None if counted.states is None else frozenset(counted.states)
    tally = OutcomeCounter(draws, counted.target, states, counted.robust)
    tally.count(n, None)
    return tally.successes
