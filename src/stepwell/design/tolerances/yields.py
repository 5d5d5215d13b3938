"""Yield: the fraction of random samples within tolerances that reach the target."""

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
from stepwell.design.tolerances import draws, survival, tally as tallies
from stepwell.design.tolerances.draws import Draws
from stepwell.design.tolerances.sensitivity import Sensitivities, gaps_of_built, sensitivities
from stepwell.design.tolerances.tally import Counted, OutcomeCounter, RelayJudge
from stepwell.mechanism import Cell, Chain

if TYPE_CHECKING:
    import xarray as xr

    from stepwell.proof import ToleranceProof


_SHOWN = 4  # outcomes printed
_COMPARED = 1000  # samples whose gap is compared with the simulation


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Critical(base.ByValue):
    """The two cells whose order is most often reversed.

    Attributes:
        first, second: the numbers of the cells; `first` should move before `second`.
        names: their names, with the phases if a cell has more than two.
        way: "loading", decided by F0 plus friction, or "unloading", by F1 less friction.
        fraction: fraction of the samples in closed form that have them in the other order.
        narrowest: fraction in which their gap is the smallest of all.
        by: the force that decides: "F0", "F1", or that of the switches up or down.
    """

    first: int
    second: int
    names: tuple[str, str]
    way: str
    fraction: float
    narrowest: float
    by: str = ""

    def __str__(self):
        before, after = self.names
        return (
            f"{before} moves before {after} while {self.way} ({self.by}); "
            f"{base.percent(self.fraction)} of the samples reverse this order"
        )


@dataclass(frozen=True, eq=False)
class Yield(Counted, base.Drawn):
    """Number of random samples within tolerances that reach the target.

    Attributes:
        chain, tolerances: the nominal design and its tolerances.
        samples, seed: number of samples, and random seed.
        fraction, interval: successes over samples, and the 95 % confidence interval of the
            probability (Clopper & Pearson 1934).
        target: the sequence of states of a full cycle; or "states" and the target states.
        states: all states reachable from all cells at 0, and no others; None for a cycle.
        successes: number of samples that reach the target without a tie.
        outcomes: outcomes of the others, most frequent first: a sequence, or the differences from
            the target states; "a tie", "cannot be built", "no answer" from the engine, "another
            sequence" for all others (chains of ten cells or more, the rarest ones).
        critical: the neighbours in the target order that are most often in the other order, or
            nearest to it; None if no sample was in closed form, or there is no such pair.
        by_engine: number of simulated samples.
        robust: the mobility ratio up to which the target must be reached; None for nominal ones.
        proved: number of successes proved for all these mobilities: in closed form they do not
            matter, and landings may be proved. Other landings were sampled. None if `robust` is.
        assumptions: of this result.
        sensitivities: indices of each part's tolerance; None unless asked for.
        advice: if no sample reaches the target, the reason and an alternative; else "".
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
        """Sample `number`, from 0; ValueError for no such number or if it cannot be built."""
        if not 0 <= number < self.samples:
            raise base.InputError(f"number = {number}: must be between 0 and {self.samples - 1}.")
        return Draws(self.chain, self.tolerances, self.seed).sample(number)

    def prove(self, progress: base.Progress = None) -> "ToleranceProof":
        """Prove that every machine within the tolerances reaches the target; or refute it by one.

        Needs python-flint, the extra `proof`.

        Args:
            progress: called with (done, total) samples, where no theorem decides.

        Raises:
            ValueError: the target is a set of states, or mobilities have a tolerance.
            ExtraError: python-flint is not installed.

        Source: ours (theory page, "Proofs within tolerances").
        """
        from stepwell import proof

        if self.states is not None:
            raise base.InputError(
                "states: the proof is about a sequence; leave the target states out, and the "
                "target is the cycle of the nominal design."
            )
        return proof.prove_tolerances(self.chain, self.tolerances, self.target, progress)

    def end_forces(self, n: int = 1000) -> base.Floats:
        """Critical forces of the cells of the first n samples, for a cloud around each cell.

        (m, T, 2) F0 plus friction and F1 less friction [N]; for elements the forces up and down of
        each switch. T = N for cells of two phases, m = min(n, self.samples), NaN for samples that
        cannot be built.
        """
        forces = np.full((min(n, self.samples), *switching_forces(self.chain).shape), np.nan)
        for number in range(len(forces)):
            with suppress(ValueError):
                forces[number] = switching_forces(self.mechanism(number))
        return forces

    def to_xarray(self) -> "xr.Dataset":
        """Counts over "outcome", the target first, and indices over "parameter"."""
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
            "fraction": self.fraction,
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
        """Write one line per outcome, the target first."""
        counts = self._counts.values()
        fractions = [count / self.samples for count in counts]
        columns = [base.Quantity("outcome"), base.Quantity("count"), base.Quantity("fraction", "1")]
        base.write_csv(path, zip(columns, (self._counts, counts, fractions), strict=True), 9)

    @property
    def _counts(self) -> dict[str, int]:
        return {self.target: self.successes, **self.outcomes}

    def __str__(self):
        low, high = map(base.percent, self.interval)
        lines = [
            f"{base.percent(self.fraction)} of {self.samples} samples reach {short(self.target)} "
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
            lines += ["fraction of the variance of the smallest gap:", str(self.sensitivities)]
        return "\n".join([*lines, self.assumptions])

    def __repr__(self):
        low, high = map(base.percent, self.interval)
        return (
            f"Yield({short(self.target)}: {base.percent(self.fraction)} of {self.samples}, "
            f"{low} to {high}, {self.tolerances!r})"
        )


def yields(
    chain: Chain,
    tolerances: draws.Tolerances = draws.DEFAULT_TOLERANCES,
    *,
    samples: int | None = None,
    seed: int = 0,
    target: str | Iterable[str] | None = None,
    sensitivity: bool = False,
    robust: float | None = None,
    progress: base.Progress = None,
) -> Yield:
    """Compute the fraction of random samples within tolerances that reach the target.

    All else as for `Chain.yields`.
    """
    _check_arguments(chain, tolerances, base.ONE_BY_ONE if samples is None else samples, seed)
    robust = None if robust is None else statics.checked_ratio("robust", robust)
    states = _checked_states(chain, tolerances, target)
    drawing = sequences.cycle(chain) if target is None or states is not None else None
    ends = chain.last_state, "target", chain.names
    sequence = str(drawing.sequence) if drawing else checked_cycle(str(target), *ends)
    tally = OutcomeCounter(Draws(chain, tolerances, seed), sequence, states, robust)
    if sensitivity and tally.orders is None:
        raise base.InputError(
            f"sensitivity = True needs a target that changes one cell per step, and in "
            f"{short(sequence)} a step changes several: leave it out, or choose another cycle."
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
            f"target = {sorted(states)}: must be states of {len(chain)} {digits}, one per "
            f"cell, cell 1 (the inner one) first."
        )
    why = unsearchable(chain, tolerances.most.friction)
    if why:
        raise base.InputError(
            f"target = {short(' '.join(sorted(states)))}: {why}; give a full cycle instead."
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
    each = tolerances.each(len(chain))
    for name, cell, own in zip(chain.names, chain.cells, each, strict=True):
        if isinstance(cell, Cell) and own.lever >= cell.lever:
            raise base.InputError(
                f"lever = {own.lever} m: must be smaller than the lever of {name}, "
                f"{cell.lever:.6g} m."
            )
    draws.validate(tolerances, chain)


def _advice(tally: OutcomeCounter, target: str) -> str:
    if tally.successes:
        return ""
    if tally.outcomes().get(tallies.BY_MOBILITY):
        return (
            "no sample reaches the target for all mobilities of its cells: use a smaller ratio, or "
            "in Python compute the yield with Tolerances(mobility=...)"
        )
    if tally.states is None:
        return tallies.zero_yield_reason(tally.draws.chain, target, tally.by_engine == 0)
    states = reached(tally.draws.chain)
    text = short(" ".join(states.states))
    return f"no sample reaches the target; the nominal design reaches {text}"


def _sensitivities(tally: OutcomeCounter, n: int) -> Sensitivities:
    draws, judge, orders = tally.draws, tally.judge, tally.orders
    if judge is not None:
        return sensitivities(draws, lambda rows: judge(rows).gap)
    assert orders is not None
    indices = sensitivities(draws, lambda rows: gaps_of_built(draws, orders, rows), built=True)
    # Every sample was simulated, so the agreement of the gap with the simulation is known.
    some = np.array(tally.succeeded[:_COMPARED])
    gaps = gaps_of_built(draws, orders, next(draws.chunks(n))[: len(some)])
    return replace(indices, agreed=float(np.mean((gaps > 0) == some[: len(gaps)])))


def _critical(tally: OutcomeCounter) -> Critical | None:
    """The pair most often in the other order, and among several the one most often nearest."""
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
    fractions = int(wrong[worst]) / tally.by_form, int(narrowest[worst]) / tally.by_form
    pair = names[first], names[second]
    return Critical(cell[first], cell[second], pair, way, *fractions, by[side])


def _assumptions(tally: OutcomeCounter, n: int, drawing: sequences.Cycle | None) -> Iterator[str]:
    if tally.states is not None:
        how = (
            f"{tally.by_engine} samples simulated along every branch"
            + (n > tally.by_engine)
            * f", {n - tally.by_engine} proved to reach all states (all loops nested)"
        )
    elif isinstance(tally.judge, RelayJudge):
        how = (
            f"{tally.by_form} samples evaluated by their switching forces, which decide under a "
            f"prescribed force (independent elements)"
        )
    elif tally.judge is None and tally.draws.chain.elements:
        how = f"all {n} samples simulated, since elements interact under this drive"
    elif tally.judge is None:
        how = (
            f"all {n} samples simulated, since there is no closed form for these cells (several "
            f"bands, a nonlinear elastic law or a load)"
        )
    else:
        how = (
            f"{tally.by_form} samples evaluated in closed form (every cell proved in tension with "
            f"falling force), {tally.by_engine} by simulation"
        )
    sampling = tallies.sampling_text(tally.draws.chain) + " full cycle" * (tally.states is None)
    fails = "ties and failed samples count as failures"
    yield f"{sampling}; {fails}; {how}"
    if tally.robust is not None:
        sampled = tally.successes - tally.proved
        rest = f", {sampled} with landings tested by sampling" * (sampled > 0)
        proved = f" ({tally.proved} proved{rest})" * (tally.successes > 0)
        yield f"successes hold for all mobility ratios up to {tally.robust:g}{proved}"
    yield draws.frictionless(tally.draws.tolerances, tally.draws.chain)
    yield "the nominal design is a tie" if drawing and drawing.degenerate else ""


def parts_of(counted: Yield | survival.Survival) -> dict[str, draws.SampledPart]:
    """The varied parts of a yield by their names, such as "outer.stiffness"."""
    return Draws(counted.chain, counted.tolerances, counted.seed).parts


def with_tightened_tolerance(
    counted: Yield | survival.Survival, part: str, left: float, n: int
) -> int:
    """Successes of the first n samples if one part has the fraction `left` of its tolerance.

    The random numbers are the same. Only that part, named as in `parts_of`, is nearer to its
    nominal value, and friction to the middle of its tolerance.
    """
    draws = Draws(counted.chain, counted.tolerances, counted.seed, part, left)
    if isinstance(counted, survival.Survival):
        return survival.count_ends(draws, counted.turning_points, counted.start, counted.target, n)
    states = None if counted.states is None else frozenset(counted.states)
    tally = OutcomeCounter(draws, counted.target, states, counted.robust)
    tally.count(n, None)
    return tally.successes
